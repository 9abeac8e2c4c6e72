#!/usr/bin/env bash
# A designer with a STEP assembly: what really clashes, a report for others, a session on it.
[ -x "$BUILD/bin/mortise-import-step" ] || skip "program absent: OpenCASCADE"
run ./mortise check scenarios/tensioner.step
saw '1 unexplained real, 7 explained real'
saw 'cover × bracket'
run ./mortise check scenarios/tensioner.step --html report.html --bcf issues.bcf
made report.html issues.bcf
cp scenarios/tensioner.step arm.step
run ./mortise check arm.step --propose
saw 'between:' arm.mortise.yaml
run ./mortise open arm.step --seconds 5
saw 'addresses for browsers' errors
run ./mortise replay verify sessions/arm-*.mcap
saw 'verified: .*bit for bit'
