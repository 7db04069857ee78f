# completion of `pound` for bash; it asks the program, so it knows the commands, options and names that there are

_pound() {
	local pound=${COMP_WORDS[0]} command=${COMP_WORDS[1]} word=$2 usage words=
	if [ "$COMP_CWORD" -eq 1 ]; then
		words=$("$pound" --help | sed -n 's/^  \([a-z][a-z]*\) .*/\1/p')
	elif [[ $word == -* ]]; then
		words=$("$pound" "$command" --help | grep -oE -e '--[a-z][a-z-]*' | sort -u)
	else
		usage=$("$pound" --help | sed -n "s/^  $command \(.*\)/\1/p")
		case $usage in
		'[NAME]'*) words=$("$pound" example --names) ;;
		FIGURE*) [ "$COMP_CWORD" -eq 2 ] && words=$("$pound" plot --names | sed 's/ .*//') ;;
		esac
		# ids of the server, if it answers
		[[ $usage == *ID* && -z $words ]] &&
			words=$("$pound" list --limit 100 --format csv 2>/dev/null | sed '1d; s/,.*//')
	fi
	mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}
complete -o default -F _pound pound
