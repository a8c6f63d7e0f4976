# Reads what `--help` prints. Says what is in it, a line each, in fields that tabs separate:
#   text LINE | usage LINE | section TITLE | item HEAD MEANING | example COMMAND
function finish() {
  if (head != "") print "item", head, meaning
  head = meaning = ""
}

# A meaning stands from column 31 on, of a long head on the next line.
function begin_item(line, next_line) {
  if (length(line) > 30 && substr(line, 30, 1) == " " &&
      (substr(line, 29, 1) == " " || substr(next_line, 1, 30) != margin)) {
    head = substr(line, 3, 28)
    meaning = substr(line, 31)
  } else {
    head = substr(line, 3)
  }
  sub(/ +$/, "", head)
}

function take(line, next_line) {
  if (head != "" && substr(line, 1, 30) == margin) {
    meaning = meaning (meaning == "" ? "" : " ") substr(line, 31)
    return
  }
  finish()
  if (example && line ~ /^  /) {
    print "example", substr(line, 3)
    return
  }
  example = 0
  if (sub(/^Example: */, "", line)) {
    example = 1
    if (line != "") print "example", line
  } else if (sub(/^Usage: /, "", line)) {
    print "usage", line
  } else if (line ~ /^[A-Z].*:$/) {
    print "section", substr(line, 1, length(line) - 1)
  } else if (line ~ /^  [^ ]/) {
    begin_item(line, next_line)
  } else {
    print "text", line
  }
}

BEGIN {
  OFS = "\t"
  margin = sprintf("%30s", "")
}
{ lines[NR] = $0 }
END {
  for (i = 1; i <= NR; ++i) take(lines[i], lines[i + 1])
  finish()
}
