cmake_minimum_required(VERSION 3.25)
# Turns files into a C++ table of paths and texts, embedded_files() of pipeline/cell.
#   cmake -DFILES=path=file;path=file -DOUTPUT=x.cpp -P EmbedFiles.cmake
set(entries "")
foreach(entry IN LISTS FILES)
  string(REGEX MATCH "^([^=]+)=(.*)$" matched "${entry}")
  file(READ "${CMAKE_MATCH_2}" text)
  string(APPEND entries "    {\"${CMAKE_MATCH_1}\", R\"hotblade(${text})hotblade\"},\n")
endforeach()
file(WRITE "${OUTPUT}" "#include \"pipeline/cell/embedded.hpp\"

namespace hotblade::pipeline {
namespace {
constexpr EmbeddedFile kFiles[] = {
${entries}};
}  // namespace

std::span<const EmbeddedFile> embedded_files() {
  return kFiles;
}
}  // namespace hotblade::pipeline
")
