#!/usr/bin/env bash
# Plans a sample and writes every exchange format into DIR: write_files.sh HOTBLADE SAMPLES DIR
set -euo pipefail
hotblade=$1 samples=$2 dir=$3
rm -rf "$dir"
mkdir -p "$dir"
job=$dir/job
"$hotblade" -q plan "$samples/barrel_vault.obj" --config "$samples/barrel_vault.toml" -o "$job" > /dev/null
for format in dxf svg csv gcode; do
  "$hotblade" -q ribs "$job/program.json" --format "$format" -o "$dir/$format" > /dev/null
  "$hotblade" -q ribs "$job/program.json" --format "$format" --arcs -o "$dir/${format}_arcs" > /dev/null
done
for format in obj ply csv compas rapid krl; do
  "$hotblade" -q export "$job/program.json" --format "$format" -o "$dir/export_$format" > /dev/null
done
"$hotblade" -q preview "$job/program.json" --design "$samples/barrel_vault.obj" --export "$dir/scene.gltf" > /dev/null
