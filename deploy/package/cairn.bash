# Completion for bash of Cairn's commands and options. Made when the package was, of what --help says.
# Loaded from within a function: hence -g.
# shellcheck disable=SC2190 # the tables are put in
declare -gA _cairn_commands=(
@bash.commands@
)
# shellcheck disable=SC2190
declare -gA _cairn_options=(
@bash.options@
)
# shellcheck disable=SC2190
declare -gA _cairn_values=(
@bash.values@
)

_cairn() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[0]##*/} word offered
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    [ -z "${_cairn_options[$command $word]+there}" ] || command+=" $word"
  done
  offered=${_cairn_commands[$command]}
  [[ $current != -* ]] || offered=${_cairn_options[$command]}
  for word in ${_cairn_values[$command]}; do
    # One of a few words, or a file, which bash looks for where nothing is offered.
    [[ $word != "$previous="* ]] || offered=${word#*=}
  done
  mapfile -t COMPREPLY < <(compgen -W "${offered//,/ }" -- "$current")
}
complete -o default -F _cairn cairn cairn-worker cairn-reproduce cairn-sim
