#!/usr/bin/env bash
# An analyst with the log of a session: what happened, why, what other tolerances would have changed.
cp "$SOURCE/tests/golden/thin_wall.mcap" day.mcap
run ./mortise replay info day.mcap
saw 'ticks'
run ./mortise replay report day.mcap
saw 'cube'
run ./mortise replay explain day.mcap 1
saw 'µm'
run ./mortise replay export day.mcap --html day.html --csv tables --sqlite day.sqlite --bcf day.bcf
made day.html tables/clashes.csv day.sqlite day.bcf
run "./mortise replay whatif day.mcap --set 'tolerance cube = ±0.02'"
saw 'tolerance cube'
run "./mortise replay whatif day.mcap --sweep 'tolerance cube = ±[0.005..0.03/4]'"
saw '0\.03'
/usr/bin/python3 -c 'import mortise' 2>/dev/null || skip "program absent: pybind11 or numpy"
run "/usr/bin/python3 -c 'import mortise; print(mortise.Log(\"day.mcap\")[\"clashes\"][\"worst_tick\"])'"
