# awk -f summary.awk FILE: one line of what ctest wrote by --output-junit: how many tests passed, failed and were skipped, and for which
# categories of reasons. A skipped test of GoogleTest prints "...: Skipped" and "category: reason" below, a script "SKIPPED: category: reason".
function plain(text) {
  gsub(/&lt;/, "<", text); gsub(/&gt;/, ">", text); gsub(/&quot;/, "\"", text); gsub(/&apos;/, "'", text); gsub(/&amp;/, "\\&", text)
  return text
}
/^\t<testcase / { status = $0; sub(/.* status="/, "", status); sub(/".*/, "", status); reason = ""; below = 0 }
/<skipped message="Unable to find/ { status = "fail" }
status == "notrun" && reason == "" {
  if (below && $0 != "") reason = $0
  below = /: Skipped$/
  if (match($0, /(SKIPPED|skipped): /)) reason = substr($0, RSTART + RLENGTH)
}
/^\t<\/testcase>/ {
  if (status == "run") ++passed
  else if (status == "fail") ++failed
  else {
    sub(/:.*/, "", reason)
    ++skipped
    ++why[reason == "" ? "no reason given" : plain(reason)]
  }
}
END {
  printf "mortise: %d passed, %d failed, %d skipped", passed, failed, skipped
  for (reason in why) {
    printf "%s%d %s", mentioned++ ? ", " : ": ", why[reason], reason
  }
  print ""
}
