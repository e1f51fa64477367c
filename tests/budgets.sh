#!/usr/bin/env bash
# Size budgets: a file has at most 400 lines (more is a warning, more than 800 a fault), a function at most 60 (more
# than 100 is a fault) and nine of ten functions at most 30. Tables of data are no code. Prints a table.
# A function is found by its braces: a line outside any function that ends in `{`, opens a parameter list and is no
# type, namespace or initialiser; lambdas and local types belong to the function around them.
set -euo pipefail
cd "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")/.."

mapfile -t files < <(find src parser materials -name '*.h' -o -name '*.cpp' |
    grep -v -E '/data/|_data\.|_table\.cpp$|diagnostic_catalogue\.cpp$' | sort)
[[ ${#files[@]} -gt 0 ]] || exit 0

awk '
function finish_file() {
    if (file == "") return
    ++file_count[folder]; line_sum[folder] += lines; if (lines > longest[folder]) longest[folder] = lines
    if (lines > 800) { printf "FAULT    %s has %d lines (at most 800)\n", file, lines; ++faults }
    else if (lines > 400) printf "warning  %s has %d lines (budget 400)\n", file, lines
}
FNR == 1 {
    finish_file()
    file = FILENAME; lines = 0; depth = 0; inside = 0; pending = ""; comment = 0
    folder = file; sub(/^src\//, "", folder); sub(/\/[^\/]*$/, "", folder)
}
{
    ++lines
    text = $0
    gsub(/\\./, "", text); gsub(/"[^"]*"/, "\"\"", text); gsub(/\047[^\047]*\047/, "0", text); sub(/\/\/.*/, "", text)
    if (text ~ /^#/) next
    if (!inside) {
        pending = pending " " text
        if (text ~ /\{ *$/ && pending ~ /\(/ &&
            pending !~ /^ *(struct|class|enum|union|namespace|template *<[^>]*> *(struct|class))[^(]*$/ && pending !~ /= *\{ *$/) {
            inside = 1; start_depth = depth; start_line = FNR
        }
        if (text ~ /[;{}] *$/) pending = ""
    }
    opened = gsub(/\{/, "{", text); closed = gsub(/\}/, "}", text)
    depth += opened - closed
    if (inside && depth <= start_depth) {
        inside = 0
        length_of = FNR - start_line + 1
        lengths[++functions] = length_of
        if (length_of > longest_function[folder]) longest_function[folder] = length_of
        if (length_of > 100) { printf "FAULT    %s:%d: a function of %d lines (at most 100)\n", file, start_line, length_of; ++faults }
        else if (length_of > 60) printf "warning  %s:%d: a function of %d lines (budget 60)\n", file, start_line, length_of
    }
}
END {
    finish_file()
    printf "%-22s %6s %8s %13s %17s\n", "folder", "files", "lines", "longest file", "longest function"
    for (f in file_count) printf "%-22s %6d %8d %13d %17d\n", f, file_count[f], line_sum[f], longest[f], longest_function[f] | "sort"
    close("sort")
    for (i = 1; i <= functions; ++i) ++histogram[lengths[i]]
    for (n = 1; n <= 1000 && seen < 0.9 * functions; ++n) seen += histogram[n]
    printf "%d functions of several lines, 90 %% have at most %d lines (budget 30)\n", functions, n - 1
    if (n - 1 > 30) { print "FAULT    too many long functions"; ++faults }
    exit faults > 0
}' "${files[@]}"
