# Makes a manual page of what help.awk says of a command. -v name=cairn-run -v version=… -v date=… -v see="cairn cairn-map"
function plain(text) {
  gsub(/\\/, "\\e", text)
  gsub(/-/, "\\-", text)
  return text ~ /^[.']/ ? "\\&" text : text
}

# What is a sentence of its own in the first line, for whatis(1).
function summary(text) {
  sub(/[:.] .*/, "", text)
  sub(/[.:]$/, "", text)
  return text
}

function section(title) {
  if (title == in_section) return
  in_section = title
  print ".SH \"" plain(toupper(title)) "\""
  blank = 0
}

BEGIN { FS = "\t" }
NR == 1 {
  print ".TH \"" plain(toupper(name)) "\" 1 \"" date "\" \"Cairn " version "\" \"Cairn\""
  section("name")
  print plain(name) " \\- " plain(summary($2))
}
$1 == "usage" { usage = $2; next }
$1 == "text" { texts[++count] = $2; after[count] = usage != "" && items; next }
$1 == "section" { parts[++part] = $2; next }
$1 == "item" { items = 1; heads[part, ++held[part]] = $2; meanings[part, held[part]] = $3 }
$1 == "example" { examples[++shown] = $2 }

function print_texts(late,   i) {
  for (i = 1; i <= count; ++i) {
    if (after[i] != late) continue
    if (texts[i] == "") { blank = 1; continue }
    section(late ? "notes" : "description")
    if (blank) print ".PP"
    blank = 0
    print plain(texts[i])
  }
}

END {
  section("synopsis")
  print "\\fB" plain(usage) "\\fP"
  print_texts(0)
  for (p = 1; p <= part; ++p) {
    section(parts[p] == "Subcommands" ? "commands" : parts[p])
    for (i = 1; i <= held[p]; ++i) {
      print ".TP\n\\fB" plain(heads[p, i]) "\\fP"
      print plain(meanings[p, i])
    }
  }
  print_texts(1)
  if (shown) {
    section("example")
    print ".nf"
    for (i = 1; i <= shown; ++i) print plain(examples[i])
    print ".fi"
  }
  section("see also")
  pages = split(see, page, " ")
  for (i = 1; i <= pages; ++i) print ".BR " plain(page[i]) " (1)" (i < pages ? "," : "")
}
