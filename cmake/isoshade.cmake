# Dependencies, compiler flags and helper functions for all targets.

find_package(Threads REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(fmt REQUIRED)
find_package(glm REQUIRED)
find_package(CLI11 REQUIRED)
find_package(TBB REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)
find_package(OpenEXR 3.1 REQUIRED)
find_package(ZLIB REQUIRED)
find_path(TINYGLTF_INCLUDE_DIR tiny_gltf.h REQUIRED)
# glslang's package file refers to SPIRV-Tools without finding it.
find_package(SPIRV-Tools REQUIRED)
find_package(SPIRV-Tools-opt REQUIRED)
find_package(glslang REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(spng REQUIRED IMPORTED_TARGET spng)
pkg_check_modules(jpeg REQUIRED IMPORTED_TARGET libjpeg)
pkg_check_modules(mpfr REQUIRED IMPORTED_TARGET mpfr gmp)

# Float arithmetic as README.md ("The contract") specifies it: no contraction, and no constant folding in another rounding
# or denormal mode than at run time. All our objects are compiled with these flags, and generated code too.
set(ISOSHADE_FLOAT_FLAGS -ffp-contract=off -frounding-math -fwrapv)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND ISOSHADE_FLOAT_FLAGS -fsignaling-nans)
endif()

add_library(isoshade_flags INTERFACE)
target_compile_options(isoshade_flags INTERFACE -Wall -Wextra -Werror ${ISOSHADE_FLOAT_FLAGS})
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # g++ 12 warns of overlapping copies inside std::string that cannot happen (GCC bug 105329).
  target_compile_options(isoshade_flags INTERFACE -Wno-restrict)
endif()
target_include_directories(isoshade_flags INTERFACE ${PROJECT_SOURCE_DIR})

# isoshade_library(NAME SOURCES file... [LINKS target...] [PRIVATE_LINKS target...])
# One static library for each folder. The public links define the layering; a test checks that includes respect it.
function(isoshade_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;LINKS;PRIVATE_LINKS" ${ARGN})
  if(arg_SOURCES)
    add_library(isoshade_${name} STATIC ${arg_SOURCES})
    target_link_libraries(isoshade_${name} PUBLIC isoshade_flags ${arg_LINKS} PRIVATE ${arg_PRIVATE_LINKS})
  else()
    add_library(isoshade_${name} INTERFACE)
    target_link_libraries(isoshade_${name} INTERFACE isoshade_flags ${arg_LINKS})
  endif()
endfunction()
