# Long with ISOSHADE_FULL=1 in the environment: then they visit every float.
isoshade_test(functions_accuracy_test
  SOURCES
    accuracy/functions_accuracy_test.cpp
    accuracy/monotone_test.cpp
    accuracy/tiers_accuracy_test.cpp
  LINKS isoshade_functions isoshade_reference
  LABEL accuracy
  TIMEOUT 7200)

# Also long with ISOSHADE_FULL=1.
isoshade_test(angles_test
  SOURCES accuracy/angles_test.cpp
  LINKS isoshade_functions
  LABEL accuracy
  TIMEOUT 7200)

isoshade_test(derivatives_accuracy_test
  SOURCES accuracy/derivatives_accuracy_test.cpp
  LINKS isoshade_passes isoshade_reference
  LABEL accuracy)

isoshade_test(pixel_derivatives_test
  SOURCES accuracy/pixel_derivatives_test.cpp
  LINKS isoshade_render isoshade_compare isoshade_cpu isoshade_interpreter
    $<$<BOOL:${ISOSHADE_VULKAN}>:isoshade_vulkan>
  LABEL accuracy
  TIMEOUT 300
  DEVICES)
target_compile_definitions(pixel_derivatives_test PRIVATE
  ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs" $<$<BOOL:${ISOSHADE_VULKAN}>:ISOSHADE_VULKAN>)

# Pictures, counted in pixels.
isoshade_test(cartoon_test
  SOURCES accuracy/cartoon_test.cpp
  LINKS isoshade_render isoshade_cpu isoshade_interpreter
  LABEL accuracy
  TIMEOUT 300)
target_compile_definitions(cartoon_test PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")

isoshade_test(outline_test
  SOURCES accuracy/outline_test.cpp
  LINKS isoshade_render isoshade_cpu isoshade_interpreter
  LABEL accuracy
  TIMEOUT 300)
target_compile_definitions(outline_test PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")

isoshade_test(depth_of_field_test
  SOURCES accuracy/depth_of_field_test.cpp
  LINKS isoshade_render isoshade_compare isoshade_cpu isoshade_interpreter
  LABEL accuracy
  TIMEOUT 300)
target_compile_definitions(depth_of_field_test PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")

isoshade_test(stylised_highlight_test
  SOURCES accuracy/stylised_highlight_test.cpp
  LINKS isoshade_render isoshade_compare isoshade_cpu isoshade_interpreter
  LABEL accuracy
  TIMEOUT 300)
target_compile_definitions(stylised_highlight_test PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")

isoshade_test(strokes_test
  SOURCES accuracy/strokes_test.cpp
  LINKS isoshade_render isoshade_compare isoshade_cpu isoshade_interpreter
  LABEL accuracy
  TIMEOUT 300)
target_compile_definitions(strokes_test PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")

# Pictures against what follows from their scenes.
isoshade_test(picture_accuracy_test
  SOURCES
    accuracy/blending_accuracy_test.cpp
    accuracy/fur_test.cpp
    accuracy/motion_accuracy_test.cpp
    accuracy/tier_pictures_test.cpp
    accuracy/white_sky_test.cpp
    accuracy/world_position_test.cpp
  LINKS isoshade_render isoshade_compare isoshade_cpu isoshade_interpreter isoshade_reference
  LABEL accuracy
  TIMEOUT 600)
target_compile_definitions(picture_accuracy_test PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")

if(ISOSHADE_VULKAN)
  # Forward pairs, which are outside of the contract.
  isoshade_test(forward_picture_test
    SOURCES accuracy/forward_picture_test.cpp
    LINKS isoshade_render isoshade_compare isoshade_cpu isoshade_interpreter isoshade_vulkan isoshade_bench
    LABEL accuracy
    TIMEOUT 300
    DEVICES)
  target_compile_definitions(forward_picture_test PRIVATE
    ISOSHADE_VULKAN ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs" ISOSHADE_ROOT="${PROJECT_SOURCE_DIR}")
endif()

# On every backend. `stress_test --update` writes docs/stress.md.
isoshade_test(stress_test
  SOURCES
    accuracy/brdf_test.cpp
    accuracy/stress_brdf_test.cpp
    accuracy/stress_cases.cpp
    accuracy/stress_comparison.cpp
    accuracy/stress_properties_test.cpp
    accuracy/stress_test.cpp
    accuracy/subject.cpp
  LINKS isoshade_cpu isoshade_interpreter isoshade_reference nlohmann_json::nlohmann_json
    $<$<BOOL:${ISOSHADE_VULKAN}>:isoshade_vulkan>
  LABEL accuracy
  TIMEOUT 300
  DEVICES)
target_compile_definitions(stress_test PRIVATE
  ISOSHADE_ACCURACY_DATA="${CMAKE_CURRENT_SOURCE_DIR}/accuracy/data"
  ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs"
  ISOSHADE_STRESS_PAGE="${PROJECT_SOURCE_DIR}/docs/stress.md"
  $<$<BOOL:${ISOSHADE_VULKAN}>:ISOSHADE_VULKAN>)

# With ISOSHADE_DATA in the environment; skipped without.
isoshade_test(cycles_test
  SOURCES accuracy/cycles_test.cpp
  LINKS isoshade_render isoshade_compare isoshade_cpu isoshade_interpreter
  LABEL accuracy
  TIMEOUT 300)
target_compile_definitions(cycles_test PRIVATE
  ISOSHADE_ACCURACY_GRAPHS="${CMAKE_CURRENT_SOURCE_DIR}/accuracy/graphs"
  ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")
# The maps of environments against integrals in double.
isoshade_test(environment_accuracy_test
  SOURCES accuracy/environment_accuracy_test.cpp
  LINKS isoshade_environment
  LABEL accuracy
  TIMEOUT 300)

isoshade_test(fog_test
  SOURCES accuracy/fog_test.cpp
  LINKS isoshade_render isoshade_compare isoshade_cpu isoshade_interpreter
  LABEL accuracy)
target_compile_definitions(fog_test PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")


isoshade_test(proved_test SOURCES accuracy/proved_test.cpp LINKS isoshade_prove LABEL accuracy)
target_compile_definitions(proved_test PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")

isoshade_test(bound_test
  SOURCES
    accuracy/bound_test.cpp
    accuracy/real_tape.cpp
    accuracy/subject.cpp
  LINKS isoshade_prove isoshade_cpu isoshade_interpreter isoshade_reference
    $<$<BOOL:${ISOSHADE_VULKAN}>:isoshade_vulkan>
  LABEL accuracy
  TIMEOUT 300)
target_compile_definitions(bound_test PRIVATE
  ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs"
  $<$<BOOL:${ISOSHADE_VULKAN}>:ISOSHADE_VULKAN>)

# With ISOSHADE_FULL=1 in the environment: 20,000 documents.
isoshade_test(soundness_test
  SOURCES
    accuracy/document_runs.cpp
    accuracy/random_graph.cpp
    accuracy/real_tape.cpp
    accuracy/soundness_test.cpp
  LINKS isoshade_prove isoshade_interpreter isoshade_reference
  LABEL accuracy
  TIMEOUT 7200)
target_compile_definitions(soundness_test PRIVATE ISOSHADE_GRAPHS="${PROJECT_SOURCE_DIR}/graphs")
