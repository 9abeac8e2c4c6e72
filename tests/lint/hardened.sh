#!/usr/bin/env bash
# The programs mortise-* of a folder check their stacks, and their tables of functions are read-only; exit 1: one does not. hardened.sh FOLDER
set -euo pipefail
missing=0 programs=0
lacks() { echo "$1 has no $2"; missing=1; }
for program in "$1"/mortise-*; do
  [ "$(head -c 4 "$program" | tail -c 3)" = ELF ] || continue  # a script
  programs=$((programs + 1))
  segments=$(readelf -lW "$program") dynamic=$(readelf -dW "$program") symbols=$(readelf --dyn-syms -W "$program")
  [[ $segments == *GNU_RELRO* ]] || lacks "$program" "read-only tables (-z relro)"
  [[ $dynamic == *NOW* ]] || lacks "$program" "functions bound at the start (-z now)"
  [[ $symbols == *__stack_chk_fail* ]] || lacks "$program" "checks of its stack (-fstack-protector-strong)"
done
echo "$programs programs"
[ "$programs" -gt 0 ] || exit 1
exit "$missing"
