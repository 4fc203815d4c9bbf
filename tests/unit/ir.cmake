# Tests of compiler/ir and compiler/passes.
isoshade_test(ir_test
  SOURCES
    unit/ir_expansion_test.cpp
    unit/ir_interpreter_test.cpp
    unit/ir_laws_test.cpp
    unit/ir_text_test.cpp
    unit/ir_uniformity_test.cpp
    unit/ir_validator_test.cpp
    unit/random_module.cpp
  LINKS isoshade_functions)

isoshade_test(passes_test
  SOURCES
    unit/passes_cut_long_test.cpp
    unit/passes_decide_test.cpp
    unit/passes_golden_test.cpp
    unit/passes_hoist_test.cpp
    unit/passes_keep_bits_test.cpp
    unit/passes_test.cpp
    unit/random_module.cpp
  LINKS isoshade_passes)
target_compile_definitions(passes_test PRIVATE ISOSHADE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
