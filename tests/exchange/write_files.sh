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
# The same with the arms of both cells, by poses and by joints.
for cell in two_irb4600 two_kr50; do
  "$hotblade" -q place "$job/program.json" --cell "$cell" -o "$dir/$cell" > /dev/null
  for moves in cartesian joint; do
    for format in rapid krl; do
      "$hotblade" -q export "$dir/$cell/program.json" --format "$format" --cell "$cell" --moves "$moves" \
        -o "$dir/$cell/${format}_$moves" > /dev/null
    done
  done
done
cp -r "$samples/../data/arms" "$samples/cells" "$dir"
"$hotblade" -q preview "$job/program.json" --design "$samples/barrel_vault.obj" --export "$dir/scene.gltf" > /dev/null
