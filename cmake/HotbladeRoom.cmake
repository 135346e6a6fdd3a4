# One room of the house: a folder is a target hotblade_<room> and a namespace hotblade::<room>.

add_library(hotblade_options INTERFACE)
target_compile_options(hotblade_options INTERFACE -Wall -Wextra -Wconversion -Wshadow -Wpedantic)
# Same decisions on every machine: no fused multiply-add chosen by the compiler.
target_compile_options(hotblade_options INTERFACE -ffp-contract=off)
# GCC 12 reports an overlap in `"text" + std::string` that cannot happen (GCC bug 105651).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(hotblade_options INTERFACE -Wno-restrict)
endif()
if(HOTBLADE_WERROR)
  target_compile_options(hotblade_options INTERFACE -Werror)
endif()
if(HOTBLADE_SANITIZE)
  # GCC warns of its own instrumentation where it inlines the standard library (std::regex, GCC bug 105616).
  target_compile_options(hotblade_options INTERFACE -fsanitize=${HOTBLADE_SANITIZE} -fno-omit-frame-pointer
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(hotblade_options INTERFACE -fsanitize=${HOTBLADE_SANITIZE})
  if(HOTBLADE_SANITIZE_NOT)
    target_compile_options(hotblade_options INTERFACE -fno-sanitize=${HOTBLADE_SANITIZE_NOT})
  endif()
endif()
if(HOTBLADE_SANITIZE MATCHES "thread")
  # The thread sanitizer sees nothing of what libtbb does.
  include_directories(BEFORE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/tests/threads)
endif()

# A room's sources are compiled together, which takes a third of the time: most of it goes to the same headers and the
# same templates. What keeps its own unit, for its compiler options or for what it takes in, is listed as ALONE.
set(CMAKE_UNITY_BUILD ${HOTBLADE_UNITY})
set(CMAKE_UNITY_BUILD_BATCH_SIZE 24)
if(HOTBLADE_UNITY)
  # GCC collects its garbage from 128 MiB on: 5 % of the time of a room, which needs 500 MiB and more all the same.
  set(room_type $<STREQUAL:$<TARGET_PROPERTY:TYPE>,STATIC_LIBRARY>)
  target_compile_options(hotblade_options INTERFACE
    $<$<AND:$<CXX_COMPILER_ID:GNU>,${room_type}>:--param=ggc-min-heapsize=524288>)
  # Sources that are included make GCC take their unnamed namespaces for a header's.
  target_compile_options(hotblade_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()

# hotblade_room(<room>[/<inner room>] [COLD] [SOURCES ...] HEADERS ... [PUBLIC targets...] [PRIVATE targets...]
# [ALONE ...]): the files of one folder as one target, hotblade_<room>[_<inner room>]. Each listed header must compile
# alone (tests/house). A COLD room only hands on what others compute: a release optimises it lightly, in two thirds of
# the time.
function(hotblade_room room)
  cmake_parse_arguments(ARG "COLD" "" "SOURCES;HEADERS;PUBLIC;PRIVATE;ALONE" ${ARGN})
  string(REPLACE "/" "_" target "hotblade_${room}")
  set(folder "${PROJECT_SOURCE_DIR}/${room}")
  foreach(source IN LISTS ARG_SOURCES)
    # A generated source comes with its whole path.
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY "${folder}")
    list(APPEND sources "${source}")
  endforeach()
  set(includes $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include/hotblade>)
  if(sources)
    add_library(${target} STATIC ${sources})
    list(TRANSFORM ARG_ALONE PREPEND "${folder}/")
    set_source_files_properties(${ARG_ALONE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    target_compile_features(${target} PUBLIC cxx_std_20)
    target_include_directories(${target} PUBLIC ${includes})
    target_link_libraries(${target} PUBLIC Eigen3::Eigen ${ARG_PUBLIC} PRIVATE hotblade_options ${ARG_PRIVATE})
    if(ARG_COLD)
      target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
    endif()
  else()
    add_library(${target} INTERFACE)
    target_include_directories(${target} INTERFACE ${includes})
    target_link_libraries(${target} INTERFACE Eigen3::Eigen ${ARG_PUBLIC})
  endif()
  list(TRANSFORM ARG_HEADERS PREPEND "${room}/")
  set_target_properties(${target} PROPERTIES HOTBLADE_HEADERS "${ARG_HEADERS}")
  set_property(GLOBAL APPEND PROPERTY HOTBLADE_HEADERS ${ARG_HEADERS})
  string(REGEX MATCH "^[^/]+" house_room "${room}")
  set_property(GLOBAL APPEND PROPERTY HOTBLADE_ROOMS_OF_${house_room} ${target})
endfunction()

# hotblade_whole_room(<room>): hotblade_<room>, all its inner rooms together.
function(hotblade_whole_room room)
  get_property(inner GLOBAL PROPERTY HOTBLADE_ROOMS_OF_${room})
  add_library(hotblade_${room} INTERFACE)
  target_link_libraries(hotblade_${room} INTERFACE ${inner})
endfunction()

# hotblade_test(<room>[/<inner room>] SOURCES ... [LINK targets...]): one GoogleTest program
# hotblade_<room>[_<inner room>]_tests of tests/<room>, discovered by ctest and labelled with the room. Sources of another
# folder come with their path from tests/.
function(hotblade_test room)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  string(REPLACE "/" "_" target "hotblade_${room}_tests")
  foreach(source IN LISTS ARG_SOURCES)
    if(source MATCHES "/")
      list(APPEND sources "${PROJECT_SOURCE_DIR}/tests/${source}")
    else()
      list(APPEND sources "${PROJECT_SOURCE_DIR}/tests/${room}/${source}")
    endif()
  endforeach()
  add_executable(${target} ${sources})
  # Eight sources of a room together take as long as two apart. What one of them says of itself in the unnamed namespace the
  # others see too, so that names differ within a room.
  set_target_properties(${target} PROPERTIES UNITY_BUILD_BATCH_SIZE 8)
  if(HOTBLADE_UNITY)
    target_precompile_headers(${target} REUSE_FROM hotblade_test_headers)
  endif()
  # What is tested is optimised in its own room.
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  target_link_libraries(${target} PRIVATE hotblade_options hotblade_test_paths ${ARG_LINK} GTest::gmock
    GTest::gtest_main)
  include(GoogleTest)
  # Those that plan begin before the others, so that none is left alone at the end.
  set(cost 0)
  if(room MATCHES "^pipeline")
    set(cost 10)
  endif()
  gtest_discover_tests(${target} DISCOVERY_MODE PRE_TEST
    PROPERTIES TIMEOUT ${HOTBLADE_TEST_TIMEOUT_S} LABELS ${room} COST ${cost})
endfunction()
