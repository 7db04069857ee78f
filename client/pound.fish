# completion of `pound` for fish; it asks the program, so it knows the commands, options and names that there are

function __pound_words
    set -l words (commandline -opc)
    set -l pound $words[1]
    if test (count $words) -eq 1
        $pound --help | string replace -rf '^  ([a-z]+) .*' '$1'
    else if string match -q -- '-*' (commandline -ct)
        $pound $words[2] --help | string match -rag -- '(--[a-z][a-z-]*)' | sort -u
    else
        switch ($pound --help | string replace -rf "^  $words[2] (.*)" '$1')
            case '[NAME]*'
                $pound example --names
            case 'FIGURE*'
                $pound plot --names | string replace -r ' .*' ''
                $pound list --limit 100 --format csv 2>/dev/null | string replace -r ',.*' '' | tail -n +2
            case '*ID*'
                # ids of the server, if it answers
                $pound list --limit 100 --format csv 2>/dev/null | string replace -r ',.*' '' | tail -n +2
        end
    end
end
complete -c pound -a '(__pound_words)'
