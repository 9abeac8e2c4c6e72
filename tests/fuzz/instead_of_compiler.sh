#!/bin/sh
# instead_of_compiler.sh OTHER COMPILER ARGUMENTS...: calls OTHER with what was meant for COMPILER, by way of ccache where there is one.
other=$1
shift 2
if command -v ccache >/dev/null; then exec ccache "$other" "$@"; fi
exec "$other" "$@"
