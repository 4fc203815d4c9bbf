isoshade_test(functions_test
  SOURCES
    unit/functions_documentation_test.cpp
    unit/functions_geometry_test.cpp
    unit/functions_ir_test.cpp
    unit/functions_noise_test.cpp
    unit/functions_special_values_test.cpp
    unit/functions_tiers_test.cpp
  LINKS isoshade_functions)
target_compile_definitions(functions_test PRIVATE ISOSHADE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # g++ 12 takes std::regex for uninitialised under the address sanitizer (GCC bug 105562).
  target_compile_options(functions_test PRIVATE -Wno-maybe-uninitialized)
endif()
