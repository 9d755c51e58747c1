# the lines of a C source as strings
s/[\\"]/\\&/g
s/.*/"&\\n",/
