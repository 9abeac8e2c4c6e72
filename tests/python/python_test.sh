#!/usr/bin/env bash
# Runs the tests of Python: python_test.sh SOURCE BUILD PYTHON mortise|schemas
set -euo pipefail
source=$1 build=$2 python=$3 what=$4
skip() { echo "[  SKIPPED ] program absent: $* (packages-tests.txt)"; exit 77; }
has() { "$python" -c "import $1" 2>/dev/null; }
command -v "$python" >/dev/null || skip python3
has pytest || skip python3-pytest
if [ "$what" = mortise ]; then
  has numpy || skip python3-numpy
  compgen -G "$build/python/mortise/_mortise*.so" >/dev/null || skip "pybind11-dev, when this was built"
else
  has jsonschema || skip python3-jsonschema
fi
export PYTHONPATH=$build/python PYTHONDONTWRITEBYTECODE=1 MORTISE_BIN=$build/bin MORTISE_SOURCE=$source PATH=$build/bin:$PATH
exec "$python" -m pytest -q -p no:cacheprovider "$source/tests/python/${what}_test.py"
