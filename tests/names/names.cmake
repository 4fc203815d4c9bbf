isoshade_test(names_test
  SOURCES names/compilers.cpp names/documents.cpp names/names_test.cpp names/words.cpp
  LINKS isoshade_driver
  LABEL equivalence
  TIMEOUT 3600)
target_compile_definitions(names_test PRIVATE ISOSHADE_ROOT="${PROJECT_SOURCE_DIR}")
