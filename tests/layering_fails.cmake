# The layering test can fail: a tree with one wrong include of each sort is refused with three faults.
set(tree "${WORK}/wrong_layers")
file(REMOVE_RECURSE ${tree})
file(WRITE ${tree}/src/math/vec.h "#include \"render/ray.h\"\n")           # upwards
file(WRITE ${tree}/materials/diffuse.h "#include \"lights/area_light.h\"\n") # a sibling
file(WRITE ${tree}/src/scene/build.cpp "#include <embree3/rtcore.h>\n")     # someone else's library
execute_process(COMMAND ${CMAKE_COMMAND} -DROOT=${tree} -P ${CMAKE_CURRENT_LIST_DIR}/layering.cmake
                RESULT_VARIABLE result OUTPUT_VARIABLE text ERROR_VARIABLE text)
if(result EQUAL 0 OR NOT text MATCHES "3 includes point the wrong way")
    message(FATAL_ERROR "wrong includes were not found:\n${text}")
endif()
