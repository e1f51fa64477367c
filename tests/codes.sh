#!/usr/bin/env bash
# Every code that a diagnostic can have is explained by `abbe explain`.
set -euo pipefail
cd "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")/.."
catalogue=src/base/diagnostic_catalogue.cpp
used=$(grep -rhoE --include='*.h' --include='*.cpp' --exclude="${catalogue##*/}" '"[EW]0[0-9]{3}"' src parser materials | sort -u)
known=$(grep -oE '\{"[EW]0[0-9]{3}"' "$catalogue" | tr -d '{' | sort)
twice=$(uniq -d <<<"$known")
missing=$(comm -23 <(echo "$used") <(uniq <<<"$known"))
[[ -z $twice ]] || echo "explained twice: $twice"
[[ -z $missing ]] || echo "not explained in $catalogue: $missing"
[[ -z $twice$missing ]]
