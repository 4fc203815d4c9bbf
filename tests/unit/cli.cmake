isoshade_test(cli_test
  SOURCES unit/cli_documents_test.cpp unit/cli_frames_test.cpp unit/cli_process_test.cpp unit/cli_sheet_test.cpp
          unit/cli_test.cpp
  LINKS isoshade_scene
  TIMEOUT 120
  DEVICES)
add_dependencies(cli_test isoshade)
target_compile_definitions(cli_test PRIVATE
  ISOSHADE_COMMAND="$<TARGET_FILE:isoshade>"
  ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs"
  ISOSHADE_VERSION="${PROJECT_VERSION}"
  $<$<BOOL:${ISOSHADE_VULKAN}>:ISOSHADE_VULKAN>)

# python3-jsonschema
find_package(Python3 REQUIRED COMPONENTS Interpreter)
add_test(NAME schema_test
  COMMAND Python3::Interpreter ${CMAKE_CURRENT_SOURCE_DIR}/schema_test.py
    $<TARGET_FILE:isoshade> ${PROJECT_SOURCE_DIR}/graphs)
set_tests_properties(schema_test PROPERTIES TIMEOUT 120 LABELS unit)

# chromium, chromium-driver
add_test(NAME page_in_browser_test
  COMMAND Python3::Interpreter ${CMAKE_CURRENT_SOURCE_DIR}/page_test.py
    $<TARGET_FILE:isoshade> ${PROJECT_SOURCE_DIR}/graphs)
set_tests_properties(page_in_browser_test PROPERTIES TIMEOUT 600 LABELS unit SKIP_RETURN_CODE 77)
