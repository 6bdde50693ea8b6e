# SPDX-License-Identifier: LGPL-3.0-or-later
# bash completion for mauvectl: commands, options, and live names asked from the daemon.
_mauvectl() {
  local words cword cur
  if declare -F _get_comp_words_by_ref >/dev/null; then
    _get_comp_words_by_ref -n = words cword
  else
    words=("${COMP_WORDS[@]}") cword=$COMP_CWORD
  fi
  cur=${words[cword]}
  mapfile -t COMPREPLY < <(mauvectl __complete "${words[@]:1:cword}" 2>/dev/null)
  if ((${#COMPREPLY[@]} == 0)) && [[ ${words[1]} =~ ^(apply|check|diff|plan)$ || ${words[cword - 1]} == --socket ]]; then
    compopt -o filenames
    mapfile -t COMPREPLY < <(compgen -f -- "$cur")
  elif [[ ${words[1]} == set && ${#COMPREPLY[@]} -eq 1 ]]; then
    compopt -o nospace
    COMPREPLY=("${COMPREPLY[0]}=")
  fi
}
complete -F _mauvectl mauvectl
