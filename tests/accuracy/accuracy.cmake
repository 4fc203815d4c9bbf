# Long with ISOSHADE_FULL=1 in the environment: then they visit every float.
isoshade_test(functions_accuracy_test
  SOURCES
    accuracy/functions_accuracy_test.cpp
    accuracy/monotone_test.cpp
  LINKS isoshade_functions
  LABEL accuracy
  TIMEOUT 7200)

isoshade_test(derivatives_accuracy_test
  SOURCES accuracy/derivatives_accuracy_test.cpp
  LINKS isoshade_passes
  LABEL accuracy)
