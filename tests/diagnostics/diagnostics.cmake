isoshade_test(diagnostics_test SOURCES diagnostics/diagnostics_test.cpp LINKS isoshade_support TIMEOUT 120 DEVICES)
add_dependencies(diagnostics_test isoshade)
target_compile_definitions(diagnostics_test PRIVATE
  ISOSHADE_COMMAND="$<TARGET_FILE:isoshade>"
  ISOSHADE_SOURCE="${PROJECT_SOURCE_DIR}"
  $<$<BOOL:${ISOSHADE_VULKAN}>:ISOSHADE_VULKAN>)
