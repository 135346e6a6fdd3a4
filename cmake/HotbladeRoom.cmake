# One room of the house: a folder is a target hotblade_<room> and a namespace hotblade::<room>.

add_library(hotblade_options INTERFACE)
target_compile_options(hotblade_options INTERFACE -Wall -Wextra -Wconversion -Wshadow -Wpedantic)
# GCC 12 sees overlapping copies in std::string's operator+ that are not there (GCC bug 105651).
target_compile_options(hotblade_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
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
  target_compile_options(hotblade_options INTERFACE -fsanitize=${HOTBLADE_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(hotblade_options INTERFACE -fsanitize=${HOTBLADE_SANITIZE})
endif()

# hotblade_room(<room> SOURCES ... HEADERS ... [PUBLIC targets...] [PRIVATE targets...])
function(hotblade_room room)
  cmake_parse_arguments(ARG "" "" "SOURCES;HEADERS;PUBLIC;PRIVATE" ${ARGN})
  add_library(hotblade_${room} STATIC ${ARG_SOURCES} ${ARG_HEADERS})
  set_target_properties(hotblade_${room} PROPERTIES LINKER_LANGUAGE CXX)
  target_compile_features(hotblade_${room} PUBLIC cxx_std_20)
  target_include_directories(hotblade_${room} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include/hotblade>)
  target_link_libraries(hotblade_${room} PUBLIC Eigen3::Eigen ${ARG_PUBLIC} PRIVATE hotblade_options ${ARG_PRIVATE})
  list(TRANSFORM ARG_HEADERS PREPEND "${room}/")
  set_property(GLOBAL APPEND PROPERTY HOTBLADE_HEADERS ${ARG_HEADERS})
endfunction()

# hotblade_test(<room> SOURCES ... [LINK targets...]): one GoogleTest program hotblade_<room>_tests, discovered by ctest.
function(hotblade_test room)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(hotblade_${room}_tests ${ARG_SOURCES})
  target_link_libraries(hotblade_${room}_tests PRIVATE hotblade_options ${ARG_LINK} GTest::gmock GTest::gtest_main)
  target_compile_definitions(hotblade_${room}_tests PRIVATE
    HOTBLADE_SOURCE_DIR="${PROJECT_SOURCE_DIR}" HOTBLADE_BINARY_DIR="${PROJECT_BINARY_DIR}")
  include(GoogleTest)
  gtest_discover_tests(hotblade_${room}_tests DISCOVERY_MODE PRE_TEST PROPERTIES TIMEOUT 600)
endfunction()
