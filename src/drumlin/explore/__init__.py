"""Playing with a brake on a local page: sliders in, pressure and torque out.

`knobs`: what can be turned, and the link that keeps it; `answers`: brake -> finite elements beside
a law, with what is kept from one setting to the next; `picture`: an answer as plain data to draw;
`page`: addresses -> what they answer; `serve`: the server, by the standard library. A link names a
setting, so that the server keeps nothing of a browser, and the page draws itself: a picture is a
few paths and words, some 10 kB.
"""
