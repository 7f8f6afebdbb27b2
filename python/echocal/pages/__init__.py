"""The study and a firmware as pages for a browser, a phone or a printer."""
