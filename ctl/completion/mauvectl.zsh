#compdef mauvectl
# SPDX-License-Identifier: LGPL-3.0-or-later
# zsh completion for mauvectl: commands, options, and live names asked from the daemon.
_mauvectl() {
  local -a whole begun given
  local line word
  given=("${(@Q)words[2,CURRENT-1]}" "${(Q)PREFIX}")
  while IFS= read -r line; do
    word=${line%%$'\t'*}
    if [[ $line == :files ]]; then
      _files
    elif [[ $word == *[=.] ]]; then
      begun+=("$word")
    elif [[ $line == *$'\t'* ]]; then
      whole+=("${word//:/\\:}:${line#*$'\t'}")
    else
      whole+=("${word//:/\\:}")
    fi
  done < <(mauvectl __complete "${given[@]}" 2>/dev/null)
  (( ${#begun} )) && compadd -S '' -a begun
  (( ${#whole} )) && _describe mauvectl whole
}
if [[ ${funcstack[1]} == _mauvectl ]]; then
  _mauvectl "$@"
else
  compdef _mauvectl mauvectl
  compdef _gnu_generic mauved  # its options, as its --help lists them
fi
