#!/usr/bin/env bash
# Every code that a diagnostic can have is explained by `abbe explain`, and every parameter of OpenPBR by its page.
set -euo pipefail
cd "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")/.."
catalogue=src/base/diagnostic_catalogue.cpp
used=$(grep -rhoE --include='*.h' --include='*.cpp' --exclude="${catalogue##*/}" '"[EW]0[0-9]{3}"' src parser materials | sort -u)
known=$(grep -oE '\{"[EW]0[0-9]{3}"' "$catalogue" | tr -d '{' | sort)
twice=$(uniq -d <<<"$known")
missing=$(comm -23 <(echo "$used") <(uniq <<<"$known"))
[[ -z $twice ]] || echo "explained twice: $twice"
[[ -z $missing ]] || echo "not explained in $catalogue: $missing"
parameters=$(grep -oE 'FieldType::[A-Za-z]+, "[a-z-]+"' materials/openpbr_type.cpp | cut -d'"' -f2 | grep -vx map)
silent=$(for name in $parameters; do grep -qE "\`(${name}|${name//-/_})\`" docs/openpbr.md || echo "$name"; done)
[[ -z $silent ]] || echo "not in docs/openpbr.md: $silent"
[[ -z $twice$missing$silent ]]
