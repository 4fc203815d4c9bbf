isoshade_test(reflect_test
  SOURCES
    unit/reflect_binding_test.cpp
    unit/reflect_files_test.cpp
    unit/reflect_format_test.cpp
    unit/reflect_layout_test.cpp
    unit/reflect_reflect_test.cpp
  LINKS isoshade_reflect isoshade_cpu nlohmann_json::nlohmann_json
  TIMEOUT 120)
target_compile_definitions(reflect_test PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")
