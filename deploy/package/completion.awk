# Makes of what help.awk says of a command its entries in the tables of cairn.bash and cairn.zsh: files FOLDER/SHELL.commands,
# .options and .values. -v command="cairn run" -v folder=… -v words="…" (what else may stand where a command's name may)
function quoted(text) {
  gsub(/'/, "'\\''", text)
  return "'" text "'"
}

function bash_entry(table, text) { print "  [" quoted(command) "]=" quoted(text) >>(folder "/bash." table) }
function zsh_entry(table, text) { print "  " quoted(command) " " quoted(text) >>(folder "/zsh." table) }
function word(list, text) { return list (list == "" ? "" : " ") text }
function line(list, text) { return list (list == "" ? "" : "\n") text }

# --difficulty TEXT:{paper,base}=base: one of these words; --out TEXT: a file, as far as anybody knows.
function choice(rest) { return match(rest, /\{[^}]*\}/) ? substr(rest, RSTART + 1, RLENGTH - 2) : "" }

BEGIN { FS = "\t" }
$1 == "section" { commands_follow = $2 == "Subcommands" }
$1 != "item" { next }
commands_follow {
  commands = word(commands, $2)
  described_commands = line(described_commands, $2 ":" $3)
}
$2 ~ /^-/ {
  rest = $2
  sub(/^[^ ]+ ?/, "", rest)
  names = split(substr($2, 1, length($2) - length(rest)), name, /[, ]/)
  for (i = 1; i <= names; ++i) {
    if (name[i] == "") continue
    options = word(options, name[i])
    described_options = line(described_options, name[i] ":" $3)
    if (rest != "" && rest !~ /^(Needs|Excludes):/) values = word(values, name[i] "=" choice(rest))
  }
}

END {
  count = split(words, other, " ")
  for (i = 1; i <= count; ++i) {
    commands = word(commands, other[i])
    described_commands = line(described_commands, other[i])
  }
  bash_entry("commands", commands)
  bash_entry("options", options)
  bash_entry("values", values)
  zsh_entry("commands", described_commands)
  zsh_entry("options", described_options)
  zsh_entry("values", values)
}
