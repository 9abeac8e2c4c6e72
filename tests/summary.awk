# awk -f summary.awk FILE...: one line of what ctest wrote by --output-junit: how many tests passed, failed and were skipped, and for which
# categories of reasons. A skipped test of GoogleTest prints "...: Skipped" and "category: reason" below, a script "SKIPPED: category: reason".
# With -v tails=N: before it the last N lines that each failed test printed, so that the end of a long log says why.
# With -v report=TITLE: the same by room, as a report that tests/bench/figures keeps.
function plain(text) {
  gsub(/&lt;/, "<", text); gsub(/&gt;/, ">", text); gsub(/&quot;/, "\"", text); gsub(/&apos;/, "'", text); gsub(/&amp;/, "\\&", text)
  return text
}
function attribute(key) {
  return match($0, " " key "=\"[^\"]*\"") ? substr($0, RSTART + length(key) + 3, RLENGTH - length(key) - 4) : ""
}
function row(room) {
  return sprintf("{\"room\":\"%s\",\"tests\":%d,\"passed\":%d,\"skipped\":%d,\"failed\":%d,\"seconds\":%.1f}", room,
                 passes[room] + skips[room] + fails[room], passes[room], skips[room], fails[room], seconds[room])
}
function count(list) {
  ++list[room]
  ++list["all"]
}
/^\t<testcase / {
  status = attribute("status"); test = attribute("name"); reason = ""; below = 0; lines = 0
  room = test; sub(/[.].*/, "", room)
  if (!(room in seconds)) rooms[++known] = room
  seconds[room] += attribute("time"); seconds["all"] += attribute("time")
}
/<skipped message="Unable to find/ { status = "fail" }
status == "notrun" && reason == "" {
  if (below && $0 != "") reason = $0
  below = /: Skipped$/
  if (match($0, /(SKIPPED|skipped): /)) reason = substr($0, RSTART + RLENGTH)
}
status == "fail" && tails && !/^\t<\/?testcase/ { printed[++lines] = $0 }
/^\t<\/testcase>/ {
  if (status == "run") count(passes)
  else if (status == "fail") {
    count(fails)
    told = told (told ? ",\n" : "") "\"failed: " test "\""
    if (tails) print "failed: " plain(test) ", and printed at its end:"
    for (i = lines > tails ? lines - tails + 1 : 1; i <= lines; ++i) print "  " plain(printed[i])
  } else {
    sub(/:.*/, "", reason)
    count(skips)
    ++why[reason == "" ? "no reason given" : plain(reason)]
  }
}
END {
  if (report) {
    printf "{\"tables\":[{\"title\":\"%s\",\"rows\":[", report
    for (i = 1; i <= known; ++i) printf "%s,\n", row(rooms[i])
    printf "%s]}],\n\"notes\":[%s],\n", row("all"), told
    printf "\"bars\":[{\"name\":\"%s, that failed\",\"figure\":%d,\"kind\":\"at most\",\"bound\":0,\"holds\":%s}]}\n", report,
           fails["all"], fails["all"] ? "false" : "true"
    exit
  }
  printf "mortise: %d passed, %d failed, %d skipped", passes["all"], fails["all"], skips["all"]
  for (reason in why) printf "%s%d %s", mentioned++ ? ", " : ": ", why[reason], reason
  print ""
}
