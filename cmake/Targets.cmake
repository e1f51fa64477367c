# abbe_library(name folder DEPS … PRIVATE_DEPS …): the library of one folder, abbe::name. A folder without
# sources (render: interfaces only) becomes an INTERFACE library. Project includes are written from the
# top: "base/check.h" for src/base, "parser/scanner.h", "materials/diffuse.h".
function(abbe_library name folder)
    cmake_parse_arguments(A "" "" "DEPS;PRIVATE_DEPS" ${ARGN})
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.cpp)
    list(FILTER sources EXCLUDE REGEX "/main\\.cpp$")
    if(sources)
        add_library(abbe_${name} STATIC ${sources})
        target_include_directories(abbe_${name} PUBLIC ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR})
        target_link_libraries(abbe_${name} PUBLIC ${A_DEPS} PRIVATE ${A_PRIVATE_DEPS})
    else()
        add_library(abbe_${name} INTERFACE)
        target_include_directories(abbe_${name} INTERFACE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR})
        target_link_libraries(abbe_${name} INTERFACE ${A_DEPS})
    endif()
    add_library(abbe::${name} ALIAS abbe_${name})
endfunction()

# abbe_little_run(target): its own code takes longer to compile than to run; under sanitizers that is most of the work.
function(abbe_little_run target)
    if(ABBE_SANITIZE)
        target_compile_options(${target} PRIVATE -O0) # two thirds to compile of -O1
    endif()
endfunction()

# The main program of every test, compiled once: doctest's own code is as much as ten tests.
add_library(abbe_doctest_main OBJECT ${PROJECT_SOURCE_DIR}/tests/support/doctest_main.cpp)

# abbe_test(name folder DEPS … LABEL …): one doctest executable from every .cpp of a folder under tests/.
function(abbe_test name folder)
    cmake_parse_arguments(A "INPUT" "LABEL" "DEPS" ${ARGN})
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tests/${folder}/*.cpp)
    if(NOT sources)
        return()
    endif()
    add_executable(test_${name} ${sources} $<TARGET_OBJECTS:abbe_doctest_main>)
    target_include_directories(test_${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
    target_link_libraries(test_${name} PRIVATE ${A_DEPS})
    target_compile_definitions(test_${name} PRIVATE ABBE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    abbe_little_run(test_${name})
    add_test(NAME ${name} COMMAND test_${name})
    if(A_LABEL STREQUAL quick)
        add_dependencies(quick_tests test_${name})
        if(A_INPUT)
            add_dependencies(input_tests test_${name})
            list(APPEND A_LABEL input)
        endif()
    endif()
    set_tests_properties(${name} PROPERTIES LABELS "${A_LABEL}")
endfunction()
