# bash completion of the programs of mortise: options and subcommands are asked of the program itself, files are offered for all else.
_mortise() {
  local cur prev words cword
  _init_completion 2>/dev/null || { cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]} words=("${COMP_WORDS[@]}") cword=$COMP_CWORD; }
  local program=${words[0]} command='' help choices
  if [ "$cword" -gt 1 ] && [[ ${words[1]} != -* ]] && "$program" "${words[1]}" --help 2>/dev/null | grep -q "^Usage.*${words[1]}"; then command=${words[1]}; fi
  help=$("$program" ${command:+"$command"} --help 2>/dev/null) || return
  # An option with a list of values: "--policy TEXT:{stop,slide,report}".
  if [[ $prev == --* ]]; then
    choices=$(sed -nE "s/^  ([^ ]*,)?$prev [^{ ]*\{([^}]*)\}.*/\2/p" <<<"$help" | tr ',' ' ')
    if [ -n "$choices" ]; then mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$cur"); return; fi
  fi
  if [[ $cur == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(grep -oE '^  (-[a-zA-Z],)?--[a-z0-9-]+' <<<"$help" | grep -oE -- '--[a-z0-9-]+')" -- "$cur")
    return
  fi
  # What mortise-keys does, and for whom, stands in its --help line by line.
  if [ "${program##*/}" = mortise-keys ] && [ "$prev" = --role ]; then
    mapfile -t COMPREPLY < <(compgen -W "designer observer bot gateway server" -- "$cur")
    return
  fi
  if [ "$cword" -eq 1 ]; then choices=$(sed -n "/^Subcommands:/,/^\$/s/^  \([a-z-]*\) .*/\1/p; s/^  ${program##*/} \([a-z]*\) .*/\1/p" <<<"$help"); fi
  mapfile -t COMPREPLY < <(compgen -W "${choices:-}" -- "$cur"; compgen -f -- "$cur")
}
complete -o filenames -F _mortise mortise-server mortise-bot mortise-discovery mortise-directory mortise-replay mortise-judge mortise-check mortise-lint mortise-inspect mortise-first-contact mortise-generate mortise-web mortise-keys
