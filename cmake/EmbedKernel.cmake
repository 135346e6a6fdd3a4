cmake_minimum_required(VERSION 3.25)
# Turns an OpenCL source with its quoted includes, each taken in once, into a C++ string.
#   cmake -DROOT=... -DINPUT=gpu/kernels/x.cl -DOUTPUT=x.cpp -DNAME=x_source -P EmbedKernel.cmake
set_property(GLOBAL PROPERTY embedded)

function(read_source path result)
  get_property(seen GLOBAL PROPERTY embedded)
  if(path IN_LIST seen)
    set(${result} "" PARENT_SCOPE)
    return()
  endif()
  set_property(GLOBAL APPEND PROPERTY embedded "${path}")
  file(READ "${ROOT}/${path}" text)
  string(REGEX MATCHALL "#include \"[^\"]+\"" includes "${text}")
  foreach(include IN LISTS includes)
    string(REGEX REPLACE "#include \"([^\"]+)\"" "\\1" target "${include}")
    read_source("${target}" body)
    string(REPLACE "${include}" "${body}" text "${text}")
  endforeach()
  set(${result} "${text}" PARENT_SCOPE)
endfunction()

read_source("${INPUT}" source)
file(WRITE "${OUTPUT}"
  "namespace hotblade::gpu {\nextern const char* const ${NAME};\nconst char* const ${NAME} = R\"hotblade(${source})hotblade\";\n}  // namespace hotblade::gpu\n")
