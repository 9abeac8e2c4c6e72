#!/usr/bin/env bash
# The programs mortise-* of a folder check their stacks, buffers and jumps, and their tables of functions are read-only; exit 1: one does
# not. hardened.sh FOLDER [CONFIGURATION]; as Debug nothing checks buffers
set -euo pipefail
folder=$1 configuration=${2:-Release} missing=0 programs=0
lacks() { echo "$1 has no $2"; missing=1; }
for program in "$folder"/mortise-*; do
  [ "$(head -c 4 "$program" | tail -c 3)" = ELF ] || continue  # a script
  programs=$((programs + 1))
  segments=$(readelf -lW "$program") dynamic=$(readelf -dW "$program") symbols=$(readelf --dyn-syms -W "$program")
  [[ $segments == *GNU_RELRO* ]] || lacks "$program" "read-only tables (-z relro)"
  [[ $dynamic == *NOW* ]] || lacks "$program" "functions bound at the start (-z now)"
  [[ $symbols == *__stack_chk_fail* ]] || lacks "$program" "checks of its stack (-fstack-protector-strong)"
  # Each of our programs prints or copies: __fprintf_chk, __snprintf_chk, __memcpy_chk.
  [[ $configuration == Debug || $symbols =~ __[a-z]+_chk[@[:space:]] ]] || lacks "$program" "checks of its buffers (-D_FORTIFY_SOURCE=2)"
  # The property of the whole program (IBT, SHSTK) is only there where the start-up code of the C library has it: the places where our
  # functions may be jumped to (endbr64) are counted instead. Without the option a few are left, of that start-up code.
  [[ $(uname -m) != x86_64 || $(LC_ALL=C grep -aoP '\xf3\x0f\x1e\xfa' "$program" | wc -l) -gt 100 ]] ||
    lacks "$program" "checks of jump targets (-fcf-protection)"
done
echo "$programs programs"
[ "$programs" -gt 0 ] || exit 1
exit "$missing"
