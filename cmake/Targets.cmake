# abbe_unity(target): its sources are compiled as one unit a folder, because headers cost more than what is in
# the files. So names in anonymous namespaces are unique within a folder; -DABBE_UNITY=OFF compiles each file by itself.
function(abbe_unity target)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ${ABBE_UNITY} UNITY_BUILD_BATCH_SIZE 0)
endfunction()

# abbe_compiled(name result): the target that compiles the folder of abbe::name: its group's, or its own.
function(abbe_compiled name result)
    get_property(group GLOBAL PROPERTY abbe_group_of_${name})
    if(group)
        set(${result} abbe_group_${group} PARENT_SCOPE)
    else()
        set(${result} abbe_${name} PARENT_SCOPE)
    endif()
endfunction()

# abbe_rarely_run(level target…): code that takes longer to compile than it ever runs. Level 1: tables of fields, the
# parser, scene building; two thirds to compile of -O2. Level g: commands, reports, quick tests; two thirds of that.
function(abbe_rarely_run level)
    foreach(target IN LISTS ARGN)
        if(ABBE_SANITIZE)
            target_compile_options(${target} PRIVATE -O0) # two thirds to compile of -O1
        else()
            target_compile_options(${target} PRIVATE -O${level})
        endif()
    endforeach()
endfunction()

# abbe_shareable(target…): its objects serve the program and the Python extension (python/CMakeLists.txt) alike. What no
# other library can see or replace costs the program nothing, nor do thread_local variables that the linker places.
function(abbe_shareable)
    foreach(target IN LISTS ARGN)
        set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
        target_compile_options(${target} PRIVATE -ftls-model=initial-exec)
    endforeach()
endfunction()

# abbe_library(name folder WITHOUT … GROUP … DEPS … PRIVATE_DEPS …): the library of one folder, abbe::name, but for the
# folders in it that are libraries of their own. A folder without sources (render: interfaces only) becomes an INTERFACE
# library. Project includes are written from the top: "base/check.h" for src/base, "parser/scanner.h",
# "materials/diffuse.h".
# With ABBE_GROUPS all folders of a group are compiled as one unit, because every unit reads the standard library's
# headers again; then abbe::name only stands for what it needs. Names in anonymous namespaces are unique within a group.
function(abbe_library name folder)
    cmake_parse_arguments(A "" "GROUP" "WITHOUT;DEPS;PRIVATE_DEPS" ${ARGN})
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.cpp)
    foreach(part IN LISTS A_WITHOUT)
        list(FILTER sources EXCLUDE REGEX "/${folder}/${part}/")
    endforeach()
    list(FILTER sources EXCLUDE REGEX "/main\\.cpp$")
    if(A_GROUP AND ABBE_GROUPS AND ABBE_UNITY)
        set_property(GLOBAL PROPERTY abbe_group_of_${name} ${A_GROUP})
        if(NOT TARGET abbe_group_${A_GROUP})
            add_library(abbe_group_${A_GROUP} STATIC)
            target_include_directories(abbe_group_${A_GROUP} PUBLIC ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR})
            abbe_unity(abbe_group_${A_GROUP})
            abbe_shareable(abbe_group_${A_GROUP})
        endif()
        target_sources(abbe_group_${A_GROUP} PRIVATE ${sources})
        foreach(dependency IN LISTS A_DEPS A_PRIVATE_DEPS)
            string(REPLACE "abbe::" "" other ${dependency})
            get_property(group_of_other GLOBAL PROPERTY abbe_group_of_${other})
            if(NOT "${group_of_other}" STREQUAL A_GROUP)
                target_link_libraries(abbe_group_${A_GROUP} PUBLIC ${dependency})
            endif()
        endforeach()
        add_library(abbe_${name} INTERFACE)
        target_link_libraries(abbe_${name} INTERFACE abbe_group_${A_GROUP})
    elseif(sources)
        add_library(abbe_${name} STATIC ${sources})
        target_include_directories(abbe_${name} PUBLIC ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR})
        target_link_libraries(abbe_${name} PUBLIC ${A_DEPS} PRIVATE ${A_PRIVATE_DEPS})
        abbe_unity(abbe_${name})
        abbe_shareable(abbe_${name})
    else()
        add_library(abbe_${name} INTERFACE)
        target_include_directories(abbe_${name} INTERFACE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR})
        target_link_libraries(abbe_${name} INTERFACE ${A_DEPS})
    endif()
    add_library(abbe::${name} ALIAS abbe_${name})
    if(sources AND ABBE_COVERAGE)
        abbe_compiled(${name} compiled)
        target_compile_options(${compiled} PRIVATE -fsanitize-coverage=trace-pc)
    endif()
endfunction()

# The main program of every test, compiled once: doctest's own code is as much as ten tests.
add_library(abbe_doctest_main OBJECT ${PROJECT_SOURCE_DIR}/tests/support/doctest_main.cpp)

# abbe_second_test(name suffix label filter): another test of an executable, of what a filter of doctest's takes of it.
function(abbe_second_test name suffix label filter)
    add_test(NAME ${name}_${suffix} COMMAND test_${name} ${filter})
    set_tests_properties(${name}_${suffix} PROPERTIES LABELS ${label} FAIL_REGULAR_EXPRESSION "test cases: +0 ")
endfunction()

# abbe_test(name folders DEPS … LABEL … [INPUT | INPUT_SUITE] [SWEEP]): one doctest executable from every .cpp of some
# folders under tests/. INPUT: it has the label "input", too; INPUT_SUITE: those of its cases that are in the suite
# "input" have it. SWEEP: cases in the suite "sweep" take long, because they look at all of something, and have the
# label "program" in place of "quick". APART: patterns of the files that are a test of their own, NAME_apart, so that two
# cores share a long test.
function(abbe_test name folders)
    cmake_parse_arguments(A "INPUT;INPUT_SUITE;SWEEP" "LABEL;APART" "DEPS" ${ARGN})
    list(TRANSFORM folders REPLACE "(.+)" "${PROJECT_SOURCE_DIR}/tests/\\1/*.cpp")
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${folders})
    if(NOT sources)
        return()
    endif()
    add_executable(test_${name} ${sources} $<TARGET_OBJECTS:abbe_doctest_main>)
    target_include_directories(test_${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
    target_link_libraries(test_${name} PRIVATE ${A_DEPS})
    target_compile_definitions(test_${name} PRIVATE ABBE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    abbe_unity(test_${name})
    if(NOT A_LABEL STREQUAL statistical OR ABBE_SANITIZE)
        abbe_rarely_run(g test_${name})
    endif()
    if(A_SWEEP)
        add_test(NAME ${name} COMMAND test_${name} -tse=sweep)
        abbe_second_test(${name} sweep program -ts=sweep)
    elseif(A_APART)
        add_test(NAME ${name} COMMAND test_${name} -sfe=${A_APART})
        abbe_second_test(${name} apart ${A_LABEL} -sf=${A_APART})
    else()
        add_test(NAME ${name} COMMAND test_${name})
    endif()
    if(NOT A_LABEL STREQUAL statistical)
        add_dependencies(quick_tests test_${name})
        if(A_LABEL STREQUAL quick)
            add_dependencies(unit_tests test_${name})
        endif()
        if(A_INPUT)
            add_dependencies(input_tests test_${name})
            list(APPEND A_LABEL input)
        elseif(A_INPUT_SUITE)
            add_dependencies(input_tests test_${name})
            abbe_second_test(${name} input input -ts=input)
        endif()
    endif()
    set_tests_properties(${name} PROPERTIES LABELS "${A_LABEL}")
endfunction()
