#compdef cairn cairn-worker cairn-reproduce cairn-sim
# Completion for zsh of Cairn's commands and options. Made when the package was, of what --help says.
local -A cairn_commands cairn_options cairn_values
cairn_commands=(
@zsh.commands@
)
cairn_options=(
@zsh.options@
)
cairn_values=(
@zsh.values@
)

local command=${words[1]:t} word
for word in ${words[2,CURRENT-1]}; do
  (( ${+cairn_options[$command $word]} )) && command+=" $word"
done
for word in ${=cairn_values[$command]}; do
  [[ ${word%%=*} == $words[CURRENT-1] ]] || continue
  local -a choice=(${(s:,:)word#*=})
  if (( $#choice )); then compadd -a choice; else _files; fi
  return
done
local -a offered
if [[ $words[CURRENT] == -* ]]; then
  offered=(${(f)cairn_options[$command]})
  _describe -o option offered
else
  offered=(${(f)cairn_commands[$command]})
  (( $#offered == 0 )) || _describe command offered
  _files
fi
