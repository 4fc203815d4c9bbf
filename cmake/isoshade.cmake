# Compiler flags and helper functions for all targets.

# Float arithmetic as README.md ("The contract") specifies it: no contraction, and no constant folding in another rounding
# or denormal mode than at run time. All our objects are compiled with these flags, and generated code too.
set(ISOSHADE_FLOAT_FLAGS -fno-fast-math -ffp-contract=off -frounding-math -fwrapv)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND ISOSHADE_FLOAT_FLAGS -fsignaling-nans)
endif()

add_library(isoshade_flags INTERFACE)
target_compile_options(isoshade_flags INTERFACE -Wall -Wextra -Werror ${ISOSHADE_FLOAT_FLAGS})
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # g++ 12 warns of overlapping copies inside std::string that cannot happen (GCC bug 105329).
  target_compile_options(isoshade_flags INTERFACE -Wno-restrict)
endif()
if(NOT PROJECT_IS_TOP_LEVEL)
  # The host's flags apply here too: its warnings are not ours, and we need both of these.
  target_compile_options(isoshade_flags INTERFACE -w -fexceptions -frtti)
endif()
target_include_directories(isoshade_flags INTERFACE ${PROJECT_SOURCE_DIR})

# The folder that holds isoshade/version.h in the build tree.
set(ISOSHADE_VERSION_FOLDER ${PROJECT_BINARY_DIR}/generated/include)
configure_file(${PROJECT_SOURCE_DIR}/include/isoshade/version.h.in ${ISOSHADE_VERSION_FOLDER}/isoshade/version.h @ONLY)

# isoshade_library(NAME SOURCES file... [LINKS target...] [PRIVATE_LINKS target...])
# One static library for each folder. The public links define the layering; a test checks that includes respect it.
function(isoshade_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;LINKS;PRIVATE_LINKS" ${ARGN})
  if(arg_SOURCES)
    add_library(isoshade_${name} STATIC ${arg_SOURCES})
    target_link_libraries(isoshade_${name} PUBLIC isoshade_flags ${arg_LINKS} PRIVATE ${arg_PRIVATE_LINKS})
    # The shared libraries are linked from these; hidden, calls inside of them stay direct.
    set_target_properties(isoshade_${name} PROPERTIES
      POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  else()
    add_library(isoshade_${name} INTERFACE)
    target_link_libraries(isoshade_${name} INTERFACE isoshade_flags ${arg_LINKS})
  endif()
endfunction()

# isoshade_hash_sources(VARIABLE HEADER header NAMESPACE namespace FUNCTION name FILES file...)
# Sets the variable to a source file, made when one of the files changes, that defines `std::string_view name()`: a hash of
# their contents. Caches whose entries depend on what our code does have it in their keys, so that nobody has to count
# versions by hand.
function(isoshade_hash_sources variable)
  cmake_parse_arguments(arg "" "HEADER;NAMESPACE;FUNCTION" "FILES" ${ARGN})
  set(made ${CMAKE_CURRENT_BINARY_DIR}/${arg_FUNCTION}.cpp)
  list(TRANSFORM arg_FILES PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  list(JOIN arg_FILES "," files)
  add_custom_command(
    OUTPUT ${made}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${made} -DFILES=${files} -DHEADER=${arg_HEADER} -DNAMESPACE=${arg_NAMESPACE}
            -DFUNCTION=${arg_FUNCTION} -P ${PROJECT_SOURCE_DIR}/cmake/hash_files.cmake
    DEPENDS ${arg_FILES} ${PROJECT_SOURCE_DIR}/cmake/hash_files.cmake
    COMMENT "Hashing sources: ${arg_FUNCTION}"
    VERBATIM)
  set(${variable} ${made} PARENT_SCOPE)
endfunction()

# isoshade_shared_library(NAME SOURCES file... LINKS target...)
# A library that programs link, isoshade::NAME. It contains what it needs of the static ones and exports only what
# include/isoshade declares: neither our inner interfaces nor the libraries that we link statically are part of its ABI.
function(isoshade_shared_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;LINKS" ${ARGN})
  add_library(isoshade_${name} SHARED ${arg_SOURCES})
  add_library(isoshade::${name} ALIAS isoshade_${name})
  target_link_libraries(isoshade_${name} PRIVATE isoshade_flags ${arg_LINKS})
  target_link_options(isoshade_${name} PRIVATE -Wl,--exclude-libs,ALL)
  target_include_directories(isoshade_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
    $<BUILD_INTERFACE:${ISOSHADE_VERSION_FOLDER}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(isoshade_${name} INTERFACE cxx_std_20)
  set_target_properties(isoshade_${name} PROPERTIES
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON EXPORT_NAME ${name}
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
endfunction()

# isoshade::lanes: what programs with generated C++ need. Our own objects take isoshade_lanes and isoshade_flags.
add_library(isoshade_generated INTERFACE)
add_library(isoshade::lanes ALIAS isoshade_generated)
set_target_properties(isoshade_generated PROPERTIES EXPORT_NAME lanes)
target_compile_features(isoshade_generated INTERFACE cxx_std_20)
target_compile_options(isoshade_generated INTERFACE
  -fno-fast-math -ffp-contract=off -frounding-math -fwrapv $<$<CXX_COMPILER_ID:GNU>:-fsignaling-nans>)
target_include_directories(isoshade_generated INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
