#!/bin/sh
# Runs tests of the page, or says in one line why not and exits 77 (ctest: skipped).
# usage: run.sh 18|20 [--with MODULE] FILES…   (the oldest node that will do; a module of npm that these files need besides)
oldest=$1
shift
module=playwright-core
if [ "$1" = --with ]; then
  module=$2
  shift 2
fi
cd "$(dirname "$0")" || exit 1
node=$(node -p 'process.versions.node.split(".")[0]' 2>/dev/null) || node=0
if [ "$node" -lt "$oldest" ]; then
  echo "SKIPPED: program absent: node >= $oldest for the tests of the page, here is ${node:-none}"
  exit 77
fi
if [ "$oldest" -ge 20 ]; then
  why=$(node --input-type=module -e 'import { whyNoBrowser } from "./support/browser.mjs"; console.log(await whyNoBrowser(process.argv[1]));' "$module") || why="the tests' own modules are missing"
  if [ -n "$why" ]; then
    echo "SKIPPED: program absent: a browser for the tests of the page: $why"
    exit 77
  fi
fi
exec node --test --test-reporter=spec "$@"
