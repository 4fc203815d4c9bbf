# Long with ISOSHADE_FULL=1 in the environment: then they visit every float.
isoshade_test(functions_accuracy_test
  SOURCES
    accuracy/functions_accuracy_test.cpp
    accuracy/monotone_test.cpp
  LINKS isoshade_functions isoshade_reference
  LABEL accuracy
  TIMEOUT 7200)

isoshade_test(derivatives_accuracy_test
  SOURCES accuracy/derivatives_accuracy_test.cpp
  LINKS isoshade_passes isoshade_reference
  LABEL accuracy)

isoshade_test(pixel_derivatives_test
  SOURCES accuracy/pixel_derivatives_test.cpp
  LINKS isoshade_render isoshade_cpu isoshade_interpreter
  LABEL accuracy
  TIMEOUT 300)
target_compile_definitions(pixel_derivatives_test PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")
