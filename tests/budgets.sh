#!/usr/bin/env bash
# Size budgets: a file has at most 700 lines (more is a warning, more than 800 a fault), a function at most 60 (more
# than 100 is a fault) and nine of ten functions at most 30. Tables of data are no code. Prints a table.
# And what makes code easy to find one's way in: few files a folder, files that are worth opening, headers that several
# modules share. A module is a header with its .cpp; one that no other module of the program includes, or a single one,
# counts as a header with one user.
# A function is found by its braces: a line outside any function that ends in `{`, opens a parameter list and is no
# type, namespace or initialiser; lambdas and local types belong to the function around them.
set -euo pipefail
cd "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")/.."

# What holds today, with a little room; beyond it is a fault. The aims: a median near 100 lines, fewer than 20 % below 50.
least_median=85       # lines of a file
most_short=20         # % of the files with fewer than 50 lines
most_single_user=120  # headers
most_in_folder=40     # files; more is a warning
large_folders="materials" # two files a material, whatever their number

mapfile -t files < <(find src parser materials -name '*.h' -o -name '*.cpp' |
    grep -v -E '/data/|_data\.|_table\.cpp$|diagnostic_catalogue\.cpp$' | sort)
[[ ${#files[@]} -gt 0 ]] || exit 0

awk -v least_median="$least_median" -v most_short="$most_short" -v most_single_user="$most_single_user" \
    -v most_in_folder="$most_in_folder" -v large_folders=" $large_folders " '
function finish_file() {
    if (file == "") return
    ++with_lines[lines]; ++all_files
    ++file_count[folder]; line_sum[folder] += lines; if (lines > longest[folder]) longest[folder] = lines
    if (lines > 800) { printf "FAULT    %s has %d lines (at most 800)\n", file, lines; ++faults }
    else if (lines > 700) printf "warning  %s has %d lines (budget 700)\n", file, lines
}
FNR == 1 {
    finish_file()
    file = FILENAME; lines = 0; depth = 0; inside = 0; pending = ""; comment = 0
    included_as = file; sub(/^src\//, "", included_as)
    folder = included_as; sub(/\/[^\/]*$/, "", folder)
    module = included_as; sub(/\.[a-z]+$/, "", module)
    if (included_as ~ /\.h$/) header_module[included_as] = module
}
{
    ++lines
    if (match($0, /^#include "[^"]+"/) && !((substr($0, 11, RLENGTH - 11), module) in includes)) {
        includes[substr($0, 11, RLENGTH - 11), module]
        used[++uses] = substr($0, 11, RLENGTH - 11); user[uses] = module
    }
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
    for (f in file_count)
        if (file_count[f] > most_in_folder && index(large_folders, " " f " ") == 0)
            printf "warning  %s has %d files (budget %d)\n", f, file_count[f], most_in_folder
    for (n = 0; n < 50; ++n) short_files += with_lines[n]
    for (median = 0; counted < all_files / 2; ++median) counted += with_lines[median]
    --median
    short_share = 100 * short_files / all_files
    for (i = 1; i <= uses; ++i)
        if (used[i] in header_module && header_module[used[i]] != user[i]) ++users[used[i]]
    for (h in header_module) { ++headers; if (users[h] <= 1) ++single_user }
    printf "%d files, median %d lines (at least %d), %.1f %% below 50 (at most %d %%)\n", all_files, median, least_median, short_share, most_short
    if (median < least_median) { print "FAULT    files are too small"; ++faults }
    if (short_share > most_short) { print "FAULT    too many small files"; ++faults }
    printf "%d headers, %d with one user (at most %d)\n", headers, single_user, most_single_user
    if (single_user > most_single_user) { print "FAULT    too many headers with one user"; ++faults }
    for (i = 1; i <= functions; ++i) ++histogram[lengths[i]]
    for (n = 1; n <= 1000 && seen < 0.9 * functions; ++n) seen += histogram[n]
    printf "%d functions of several lines, 90 %% have at most %d lines (budget 30)\n", functions, n - 1
    if (n - 1 > 30) { print "FAULT    too many long functions"; ++faults }
    exit faults > 0
}' "${files[@]}"
