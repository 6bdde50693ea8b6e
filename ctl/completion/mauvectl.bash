# SPDX-License-Identifier: LGPL-3.0-or-later
# bash completion for mauvectl: commands, options, and live names asked from the daemon.
_mauvectl() {
  local words cword cur line
  if declare -F _get_comp_words_by_ref >/dev/null; then
    _get_comp_words_by_ref -n = words cword
  else
    words=("${COMP_WORDS[@]}") cword=$COMP_CWORD
  fi
  cur=${words[cword]}
  COMPREPLY=()
  while IFS= read -r line; do
    case $line in
      :files)
        compopt -o filenames 2>/dev/null
        while IFS= read -r line; do COMPREPLY+=("$line"); done < <(compgen -f -- "$cur")
        ;;
      *) COMPREPLY+=("${line%%$'\t'*}") ;;
    esac
  done < <(mauvectl __complete "${words[@]:1:cword}" 2>/dev/null)
  if ((${#COMPREPLY[@]} == 1)) && [[ ${COMPREPLY[0]} == *[=.] ]]; then
    compopt -o nospace 2>/dev/null
  fi
  # bash replaces only what follows the last break of words.
  if [[ $cur == *=* && $COMP_WORDBREAKS == *=* ]]; then
    COMPREPLY=("${COMPREPLY[@]#"${cur%=*}="}")
  fi
}
complete -F _mauvectl mauvectl

# bash completion for mauved: its options, and files.
_mauved() {
  local options
  options=$(mauved --help 2>/dev/null | sed -nE 's/^  (-[a-z],)?(--[a-z-]+).*/\2/p')
  COMPREPLY=()
  if [[ ${COMP_WORDS[COMP_CWORD]} == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "${COMP_WORDS[COMP_CWORD]}")
  fi
}
complete -o default -F _mauved mauved
