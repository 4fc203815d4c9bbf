isoshade_test(analysis_test
  SOURCES
    unit/analysis_bound_test.cpp
    unit/analysis_prove_test.cpp
    unit/analysis_rules_test.cpp
    unit/analysis_sound_test.cpp
  LINKS isoshade_analysis)
target_compile_definitions(analysis_test PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")
