# Compiles generated C++ and the headers of runtime/lanes as standard C++, here and for AArch64, and runs it.
isoshade_test(portable_test
  SOURCES portable/portable_test.cpp conformance/cases.cpp conformance/inputs.cpp
  LINKS isoshade_interpreter isoshade_lanes lanes_kernels_scalar_sse2
  LABEL conformance
  TIMEOUT 600)
target_compile_definitions(portable_test PRIVATE ISOSHADE_ROOT="${PROJECT_SOURCE_DIR}")

# Links three effects, as `isoshade compile` writes them, into one program.
isoshade_test(effects_test SOURCES portable/effects_test.cpp LABEL conformance TIMEOUT 300)
add_dependencies(effects_test isoshade)
target_compile_definitions(effects_test PRIVATE
  ISOSHADE_COMMAND="$<TARGET_FILE:isoshade>"
  ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs"
  ISOSHADE_ROOT="${PROJECT_SOURCE_DIR}")
