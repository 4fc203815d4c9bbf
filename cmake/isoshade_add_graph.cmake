# isoshade_add_graph(TARGET GRAPH [WRAPPER none|forward|isoshade] [TARGETS glsl cpp glsl-es spirv] [PREFIX NAME]
#                    [PRECISION fast|default|precise] [DIVISION native|exact] [SAMPLING fetch|samplers] [LIBRARY FOLDER]
#                    [SET PARAMETER=VALUE...])
#
# Compiles an effect, a post or a function when TARGET, an executable or a library, is built:
#
#     add_executable(viewer main.cpp)
#     isoshade_add_graph(viewer shaders/glow.json)                                   # glow.glsl, glow.h
#     isoshade_add_graph(viewer shaders/glow.json WRAPPER forward TARGETS spirv)     # glow.vert.spv, glow.frag.spv
#
# WRAPPER chooses what is written, and with it the languages that there are:
#
#   none      functions to include: glsl and cpp (the default), glsl-es
#   forward   vertex and fragment shaders for a renderer of your own, of an effect or a post: glsl (the default), glsl-es, spirv
#   isoshade  the stages that isoshade's own backends run: glsl and cpp (the default), spirv
#
# - SET compiles an effect or a post for these values of parameters alone. A second variant of a document needs a target of its
#   own, such as an INTERFACE library, and with PREFIX other names.
# - The C++ of functions is included by the document's name, #include "glow.h": its folder is an include directory of TARGET.
#   For any C++, TARGET and what links it get the headers and flags of isoshade::lanes: those without which the bits would
#   depend on the compiler, such as -ffp-contract=off.
# - The C++ of stages is made with TARGET, but not compiled into it: each file is a program to be loaded, and all of them have
#   the same entry points.
# - Properties of TARGET list the files of each kind: ISOSHADE_GLSL, ISOSHADE_CPP, ISOSHADE_GLSL_ES and ISOSHADE_SPIRV (with a
#   wrapper, one file for each shader: .vert and .frag), ISOSHADE_REFLECTION, and all of them ISOSHADE_FILES.
#
# The files are made again when the graph, a function that it uses, an image that it names, or isoshade changes. With Ninja,
# files whose text stays the same keep their time, so that what is compiled from them is not compiled again. Their names follow from the
# document: CMake reads its name and, for a wrapper, its passes, and runs again when the document changes.

# Policies of the functions, whatever those of the project that calls them.
cmake_policy(PUSH)
cmake_policy(VERSION 3.21...3.25)

# A name in a document, which becomes part of a file's name. `path`: where it stands in the JSON.
function(_isoshade_read_name graph text result)
  string(JSON name ERROR_VARIABLE error GET "${text}" ${ARGN})
  if(error OR NOT name MATCHES "^[A-Za-z_][A-Za-z0-9_]*$")
    list(JOIN ARGN "." path)
    message(FATAL_ERROR "isoshade_add_graph: \"${path}\" in ${graph} is missing or is not a name")
  endif()
  set(${result} ${name} PARENT_SCOPE)
endfunction()

# Reads from a document its name, and the names of the files that compile writes with a wrapper: the part before the end, and
# `.vert` or `.frag`, in two lists.
function(_isoshade_read_document graph wrapper name_result stems_result stages_result)
  file(READ ${graph} text)
  string(JSON type ERROR_VARIABLE error TYPE "${text}" isoshade)
  if(error)
    message(FATAL_ERROR "isoshade_add_graph: ${graph} is not a document of isoshade: ${error}")
  endif()
  set(kind "")
  foreach(key effect post function)
    string(JSON type ERROR_VARIABLE error TYPE "${text}" ${key})
    if(NOT error)
      set(kind ${key})
      break()
    endif()
  endforeach()
  if(NOT kind)
    message(FATAL_ERROR "isoshade_add_graph: ${graph} is not an effect, a post or a function")
  endif()
  _isoshade_read_name(${graph} "${text}" name ${kind})
  set(${name_result} ${name} PARENT_SCOPE)

  set(stems ${name})
  set(stages .frag)
  if(wrapper STREQUAL "none")
    set(stages "")  # one text, of no stage
  elseif(kind STREQUAL "effect")
    # The passes, of the nearest document that lists them: an effect may extend another.
    set(document ${graph})
    foreach(depth RANGE 16)
      string(JSON passes ERROR_VARIABLE error LENGTH "${text}" passes)
      string(JSON base ERROR_VARIABLE has_no_base GET "${text}" extends)
      if(NOT error OR has_no_base)
        break()
      endif()
      cmake_path(GET document PARENT_PATH folder)
      cmake_path(ABSOLUTE_PATH base BASE_DIRECTORY ${folder} NORMALIZE OUTPUT_VARIABLE document)
      if(NOT EXISTS ${document})
        message(FATAL_ERROR "isoshade_add_graph: ${graph} extends ${document}, which does not exist")
      endif()
      set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${document})
      file(READ ${document} text)
    endforeach()
    if(error OR passes EQUAL 0)
      message(FATAL_ERROR "isoshade_add_graph: ${graph} has no passes, from which the names of the files follow with WRAPPER "
                          "${wrapper}")
    endif()
    set(stems "")
    set(stages "")
    math(EXPR last "${passes} - 1")
    foreach(i RANGE ${last})
      _isoshade_read_name(${graph} "${text}" pass passes ${i} name)
      string(LENGTH ${name}.${pass} length)
      if(length GREATER 200)
        message(FATAL_ERROR "isoshade_add_graph: the names of ${graph} and its pass ${pass} are too long for names of files")
      endif()
      if(wrapper STREQUAL "isoshade")
        list(APPEND stems ${name}.${pass}.vertex ${name}.${pass}.pixel)
        string(JSON cutout ERROR_VARIABLE has_no_cutout GET "${text}" passes ${i} cutout)
        if(NOT has_no_cutout)
          list(APPEND stems ${name}.${pass}.cutout)
        endif()
        string(JSON blend ERROR_VARIABLE has_no_blend GET "${text}" passes ${i} blend)
        if(NOT has_no_blend AND NOT blend STREQUAL "none")
          list(APPEND stems ${name}.${pass}.blend)
        else()
          set(has_no_blend TRUE)
        endif()
      elseif(passes EQUAL 1)
        list(APPEND stems ${name} ${name})
      else()
        list(APPEND stems ${name}.${pass} ${name}.${pass})
      endif()
      list(APPEND stages .vert .frag)
      if(wrapper STREQUAL "isoshade" AND NOT has_no_cutout)
        list(APPEND stages .frag)
      endif()
      if(wrapper STREQUAL "isoshade" AND NOT has_no_blend)
        list(APPEND stages .frag)
      endif()
    endforeach()
  elseif(wrapper STREQUAL "isoshade")
    if(kind STREQUAL "post")
      set(stems ${name}.post)
    endif()
  elseif(kind STREQUAL "function")
    message(FATAL_ERROR "isoshade_add_graph: ${graph} is a function, which has no vertices and pixels for WRAPPER forward")
  else()
    set(stems ${name} ${name})
    set(stages .vert .frag)
  endif()
  set(${stems_result} ${stems} PARENT_SCOPE)
  set(${stages_result} ${stages} PARENT_SCOPE)
endfunction()

function(isoshade_add_graph target graph)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "WRAPPER;PREFIX;PRECISION;DIVISION;SAMPLING;LIBRARY" "TARGETS;SET")
  if(arg_UNPARSED_ARGUMENTS OR arg_KEYWORDS_MISSING_VALUES)
    message(FATAL_ERROR "isoshade_add_graph: unknown or incomplete arguments "
                        "${arg_UNPARSED_ARGUMENTS}${arg_KEYWORDS_MISSING_VALUES}")
  endif()
  # The languages of each wrapper, those that are the default, and the end of the names of their files (graphs/README.md, "What
  # compile writes"); @ stands for .vert or .frag.
  if(NOT arg_WRAPPER OR arg_WRAPPER STREQUAL "none")
    set(arg_WRAPPER none)
    set(default glsl cpp)
    set(languages glsl cpp glsl-es)
    set(endings .glsl .h .es.glsl)
  elseif(arg_WRAPPER STREQUAL "forward")
    set(default glsl)
    set(languages glsl glsl-es spirv)
    set(endings @ .es@ @.spv)
  elseif(arg_WRAPPER STREQUAL "isoshade")
    set(default glsl cpp)
    set(languages glsl cpp spirv)
    set(endings @ .cpp @.spv)
  else()
    message(FATAL_ERROR "isoshade_add_graph: there is no wrapper ${arg_WRAPPER}; there are none, forward and isoshade")
  endif()
  if(NOT arg_TARGETS)
    set(arg_TARGETS ${default})
  endif()
  foreach(wanted ${arg_TARGETS})
    if(NOT wanted IN_LIST languages)
      list(JOIN languages ", " there_are)
      message(FATAL_ERROR "isoshade_add_graph: there is no ${wanted} with WRAPPER ${arg_WRAPPER}; there are ${there_are}")
    endif()
  endforeach()
  cmake_path(ABSOLUTE_PATH graph BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE)
  _isoshade_read_document(${graph} ${arg_WRAPPER} name stems stages)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${graph})

  # A folder for each wrapper, as reflections have one name with all of them.
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/${target}.isoshade)
  if(NOT arg_WRAPPER STREQUAL "none")
    string(APPEND folder /${arg_WRAPPER})
  endif()
  set(files ${folder}/${name}.json)
  get_property(added TARGET ${target} PROPERTY ISOSHADE_FILES)
  if(files IN_LIST added)
    message(FATAL_ERROR "isoshade_add_graph: ${target} already has a document of the name ${name} with WRAPPER ${arg_WRAPPER}; add "
                        "this one to another target, such as an INTERFACE library that ${target} links")
  endif()
  set_property(TARGET ${target} APPEND PROPERTY ISOSHADE_REFLECTION ${files})
  set(made_languages "")
  foreach(language ending IN ZIP_LISTS languages endings)
    if(language IN_LIST arg_TARGETS)
      list(APPEND made_languages ${language})
      string(MAKE_C_IDENTIFIER "ISOSHADE_${language}" property)
      string(TOUPPER ${property} property)
      foreach(stem stage IN ZIP_LISTS stems stages)
        string(REPLACE "@" "${stage}" end "${ending}")
        list(APPEND files ${folder}/${stem}${end})
        set_property(TARGET ${target} APPEND PROPERTY ${property} ${folder}/${stem}${end})
      endforeach()
    endif()
  endforeach()
  set_property(TARGET ${target} APPEND PROPERTY ISOSHADE_FILES ${files})

  list(JOIN made_languages "," languages)
  # A depfile for this list of files: ninja refuses one that names files which are no longer made.
  string(MD5 depfile "${files}")
  set(depfile ${folder}/${name}.${depfile}.d)
  set(options --wrapper ${arg_WRAPPER} --target ${languages} --no-lanes --depfile ${depfile})
  set(words_of_PRECISION fast default precise)
  set(words_of_DIVISION native exact)
  set(words_of_SAMPLING fetch samplers)
  foreach(option PREFIX PRECISION DIVISION SAMPLING)
    if(arg_${option} AND words_of_${option} AND NOT arg_${option} IN_LIST words_of_${option})
      list(JOIN words_of_${option} ", " there_are)
      message(FATAL_ERROR "isoshade_add_graph: there is no ${option} ${arg_${option}}; there are ${there_are}")
    endif()
    if(arg_${option})
      string(TOLOWER ${option} word)
      list(APPEND options --${word} ${arg_${option}})
    endif()
  endforeach()
  foreach(setting IN LISTS arg_SET)
    list(APPEND options --set ${setting})
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
    DEPFILE ${depfile}
    COMMENT "Compiling ${name} to ${languages}"
    VERBATIM)

  # The target waits for its sources; for those that use a library, its headers are in its include directories.
  get_target_property(type ${target} TYPE)
  set(scope PUBLIC)
  if(type STREQUAL "INTERFACE_LIBRARY")
    set(scope INTERFACE)
  endif()
  target_sources(${target} PRIVATE ${files})
  if(cpp IN_LIST made_languages)
    # What isoshade::lanes gives, but no call of target_link_libraries: the project may call it without keywords.
    set(lanes TARGET_PROPERTY:isoshade::lanes)
    target_include_directories(${target} ${scope}
      $<BUILD_INTERFACE:${folder}> $<BUILD_INTERFACE:$<${lanes},INTERFACE_INCLUDE_DIRECTORIES>>)
    target_compile_options(${target} ${scope} $<BUILD_INTERFACE:$<${lanes},INTERFACE_COMPILE_OPTIONS>>)
    target_compile_features(${target} ${scope} cxx_std_20)
    if(arg_WRAPPER STREQUAL "isoshade")
      set_source_files_properties(${files} PROPERTIES HEADER_FILE_ONLY TRUE)
    endif()
  endif()
endfunction()

cmake_policy(POP)
