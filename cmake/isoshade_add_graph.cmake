# isoshade_add_graph(TARGET GRAPH [TARGETS glsl cpp glsl-es] [PREFIX NAME] [PRECISION fast|default|precise]
#                    [DIVISION native|exact] [LIBRARY FOLDER])
#
# Compiles an effect, a post or a function when TARGET, an executable or a library, is built:
#
#     add_executable(viewer main.cpp)
#     isoshade_add_graph(viewer shaders/glow.json)      # TARGETS: glsl cpp
#
# - The C++ is included by the document's name, #include "glow.h": its folder is an include directory of TARGET, which gets
#   the headers and flags of isoshade::lanes.
# - Properties of TARGET list the files: ISOSHADE_GLSL, ISOSHADE_CPP, ISOSHADE_GLSL_ES, ISOSHADE_REFLECTION, and all of
#   them ISOSHADE_FILES.
#
# The files are made again when the graph, a function that it uses, an image that it names, or isoshade changes. Files whose
# text stays the same keep their time, so that what is compiled from them is not compiled again. After a document was given
# another name, run CMake again.

# Policies of the functions, whatever those of the project that calls them.
cmake_policy(PUSH)
cmake_policy(VERSION 3.21...3.25)

# The name that a document gives itself.
function(_isoshade_name_of graph result)
  file(READ ${graph} text)
  foreach(kind effect post function)
    string(JSON name ERROR_VARIABLE missing GET "${text}" ${kind})
    if(NOT missing)
      set(${result} ${name} PARENT_SCOPE)
      return()
    endif()
  endforeach()
  message(FATAL_ERROR "isoshade_add_graph: ${graph} is not an effect, a post or a function")
endfunction()

function(isoshade_add_graph target graph)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "PREFIX;PRECISION;DIVISION;LIBRARY" "TARGETS")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "isoshade_add_graph: unknown arguments ${arg_UNPARSED_ARGUMENTS}")
  endif()
  if(NOT arg_TARGETS)
    set(arg_TARGETS glsl cpp)
  endif()
  cmake_path(ABSOLUTE_PATH graph BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE)
  _isoshade_name_of(${graph} name)

  set(folder ${CMAKE_CURRENT_BINARY_DIR}/${target}.isoshade)
  set(all_languages glsl cpp glsl-es)
  set(extensions .glsl .h .es.glsl)
  set(languages "")
  set(files ${folder}/${name}.json)
  set_property(TARGET ${target} APPEND PROPERTY ISOSHADE_REFLECTION ${files})
  foreach(language extension IN ZIP_LISTS all_languages extensions)
    if(language IN_LIST arg_TARGETS)
      list(REMOVE_ITEM arg_TARGETS ${language})
      set(file ${folder}/${name}${extension})
      list(APPEND languages ${language})
      list(APPEND files ${file})
      string(MAKE_C_IDENTIFIER "ISOSHADE_${language}" property)
      string(TOUPPER ${property} property)
      set_property(TARGET ${target} APPEND PROPERTY ${property} ${file})
    endif()
  endforeach()
  if(arg_TARGETS)
    message(FATAL_ERROR "isoshade_add_graph: there is no target ${arg_TARGETS}; there are ${all_languages}")
  endif()
  set_property(TARGET ${target} APPEND PROPERTY ISOSHADE_FILES ${files})

  set(has_cpp FALSE)
  if(cpp IN_LIST languages)
    set(has_cpp TRUE)
  endif()
  list(JOIN languages "," languages)
  set(options --target ${languages} --no-lanes --depfile ${folder}/${name}.d)
  foreach(option PREFIX PRECISION DIVISION)
    if(arg_${option})
      string(TOLOWER ${option} word)
      list(APPEND options --${word} ${arg_${option}})
    endif()
  endforeach()
  set(library "")
  if(arg_LIBRARY)
    cmake_path(ABSOLUTE_PATH arg_LIBRARY BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE)
    set(library --library ${arg_LIBRARY})
  endif()
  add_custom_command(
    OUTPUT ${files}
    COMMAND isoshade::command --quiet ${library} compile ${graph} -o ${folder} ${options}
    DEPENDS ${graph} $<TARGET_FILE:isoshade::command>
    DEPFILE ${folder}/${name}.d
    COMMENT "Compiling ${name} to ${languages}"
    VERBATIM)

  # The target waits for its sources; for those that use a library, its headers are in its include directories.
  get_target_property(type ${target} TYPE)
  set(scope PUBLIC)
  if(type STREQUAL "INTERFACE_LIBRARY")
    set(scope INTERFACE)
  endif()
  target_sources(${target} PRIVATE ${files})
  if(has_cpp)
    # What isoshade::lanes gives, but no call of target_link_libraries: the project may call it without keywords.
    set(lanes TARGET_PROPERTY:isoshade::lanes)
    target_include_directories(${target} ${scope}
      $<BUILD_INTERFACE:${folder}> $<BUILD_INTERFACE:$<${lanes},INTERFACE_INCLUDE_DIRECTORIES>>)
    target_compile_options(${target} ${scope} $<BUILD_INTERFACE:$<${lanes},INTERFACE_COMPILE_OPTIONS>>)
    target_compile_features(${target} ${scope} cxx_std_20)
  endif()
endfunction()

cmake_policy(POP)
