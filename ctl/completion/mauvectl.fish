# SPDX-License-Identifier: LGPL-3.0-or-later
# fish completion for mauvectl: commands, options, and live names asked from the daemon.
function __mauvectl_complete
    set -l words (commandline --tokenize --cut-at-cursor --current-process)
    set -l begun (commandline --current-token --cut-at-cursor)
    for line in (mauvectl __complete $words[2..] "$begun" 2>/dev/null)
        if test "$line" = ":files"
            __fish_complete_path "$begun"
        else
            echo -- $line
        end
    end
end
complete --command mauvectl --no-files --arguments '(__mauvectl_complete)'

# fish completion for mauved: its options, and files.
function __mauved_options
    mauved --help 2>/dev/null | string replace --regex --filter '^  (?:-[a-z],)?(--[a-z-]+).*' '$1'
end
complete --command mauved --arguments '(__mauved_options)'
