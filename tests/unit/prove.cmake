isoshade_test(prove_test
  SOURCES
    unit/prove_bound_test.cpp
    unit/prove_prove_test.cpp
    unit/prove_rules_test.cpp
    unit/prove_sound_test.cpp
  LINKS isoshade_prove)
target_compile_definitions(prove_test PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")
