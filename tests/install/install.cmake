# Needs what is installed, so all of it is built before.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
add_test(NAME install_test
  COMMAND Python3::Interpreter ${CMAKE_CURRENT_SOURCE_DIR}/install/install_test.py ${PROJECT_BINARY_DIR} ${PROJECT_SOURCE_DIR})
set_tests_properties(install_test PROPERTIES TIMEOUT 600 LABELS install)
