# Discovered as whole suites: each executor computes the expected results once.
isoshade_test(conformance_test
  SOURCES conformance/cases.cpp conformance/conformance_test.cpp conformance/inputs.cpp
  LINKS isoshade_cpu isoshade_interpreter $<$<BOOL:${ISOSHADE_VULKAN}>:isoshade_vulkan>
  LABEL conformance
  TIMEOUT 900
  DEVICES)
isoshade_test(nodes_conformance_test
  SOURCES conformance/inputs.cpp conformance/node_cases.cpp conformance/nodes_test.cpp
  LINKS isoshade_cpu isoshade_interpreter $<$<BOOL:${ISOSHADE_VULKAN}>:isoshade_vulkan>
  LABEL conformance
  TIMEOUT 900
  DEVICES)
if(ISOSHADE_VULKAN)
  target_compile_definitions(conformance_test PRIVATE ISOSHADE_VULKAN)
  target_compile_definitions(nodes_conformance_test PRIVATE ISOSHADE_VULKAN)
endif()
