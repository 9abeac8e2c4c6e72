#!/usr/bin/env bash
# The recipe for a sweep over many logs (client/replay/README.md) as it is written there: recipe_test.sh SOURCE BIN
set -euo pipefail
source=$1 bin=$2
export PATH=$bin:$PATH
command -v parallel >/dev/null || { echo "SKIPPED: program absent: GNU parallel"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
mkdir days
cp "$source"/tests/golden/*.mcap days/
# The command from "parallel" on and the loop behind it, with a part that these logs have.
recipe=$(sed -n '/^parallel .*--joblog/,/^```/p' "$source/client/replay/README.md" | grep -v '^```' | sed 's/tolerance cover/tolerance cube/')
[ "$(wc -l <<<"$recipe")" -eq 4 ] || { echo "the recipe is not where it was:"; echo "$recipe"; exit 1; }
bash -euo pipefail -c "$recipe"
for log in days/*.mcap; do
  name=$(basename "$log" .mcap)
  mortise-replay whatif "$log" --sweep 'tolerance cube = ±[0.005..0.03/4]' --json >whole.json
  cmp whole.json "$name.sweep.json" || { echo "$log: shards put together are not the sweep"; exit 1; }
  echo "$log: $(grep -c '"index"' whole.json) variants, in shards and in one"
done
