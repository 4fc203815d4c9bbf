isoshade_test(cli_test SOURCES unit/cli_test.cpp TIMEOUT 120)
add_dependencies(cli_test isoshade)
target_compile_definitions(cli_test PRIVATE
  ISOSHADE_COMMAND="$<TARGET_FILE:isoshade>"
  ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs"
  ISOSHADE_VERSION="${PROJECT_VERSION}")
