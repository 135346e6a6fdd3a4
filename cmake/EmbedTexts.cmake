cmake_minimum_required(VERSION 3.25)
# Turns text files into C++ functions that return them.
#   cmake -DFILES=name=file;name=file -DHEADER=pipeline/report/page_texts.hpp -DOUTPUT=x.cpp -P EmbedTexts.cmake
set(functions "")
foreach(entry IN LISTS FILES)
  string(REGEX MATCH "^([^=]+)=(.*)$" matched "${entry}")
  file(READ "${CMAKE_MATCH_2}" text)
  string(APPEND functions "std::string_view ${CMAKE_MATCH_1}() {\n  return R\"hotblade(${text})hotblade\";\n}\n")
endforeach()
file(WRITE "${OUTPUT}" "#include \"${HEADER}\"

namespace hotblade::pipeline {
${functions}}  // namespace hotblade::pipeline
")
