# Faults of a sweep: its options, its table of cases, its folder.

sweep-no-text = is not UTF-8 text; save it as CSV in UTF-8
sweep-table-too-large = is larger than { PLAIN($most, digits: 12) } bytes; split it into several sweeps
sweep-table-without-cases = needs a header of keys and at least one case below it
sweep-table-too-wide = has { $count } columns; at most { $most } keys are varied together
sweep-table-too-long = has { PLAIN($count, digits: 12) } cases, must be at most { PLAIN($most, digits: 12) }
sweep-no-csv = is no CSV: { $reason }
sweep-count-of-cells = needs { $wanted } values, got { $got }
sweep-empty-cell = { $key }: has no value
sweep-two-units = { $key }: got "{ $got }" below a heading in { $unit }, must be a plain number

sweep-varies-twice = varies twice; give it once
sweep-unequal-lengths = needs as many values for each key, got { $got }
sweep-no-axis = got { $got }, must be KEY=RANGE
sweep-empty-value = got { $got } with an empty value
sweep-no-range = got { $got }: { $reason }
sweep-forms-of-ranges = must be START:STOP:COUNT, log:START:STOP:COUNT or random:LOW:HIGH:COUNT:SEED, or a comma list
sweep-ends-with-two-units = write both ends with the same unit, or both without (SI)
sweep-no-whole-number = { $got } must be a whole number
sweep-count-of-range = the count must be 1 to { PLAIN($most, digits: 12) }
sweep-logarithm-of-zero = a logarithmic range needs ends > 0
sweep-no-number = { $got } does not begin with a number
sweep-no-toml = TOML syntax: { $reason }
sweep-no-element = the profile has no such element; they count from 1 in brackets, e.g. { $example }; write a missing one there first
sweep-no-key = there is no such key; elements of arrays go by number, e.g. { $example }
sweep-taken-from-profile = only goes with --quantity optimal; { $quantity } takes it from the profile

sweep-folder-in-use = another sweep is at work there; wait until it ends, or give another folder with -o
sweep-folder-in-use-by = another sweep is at work there (process { $process }); wait until it ends, or give another folder with -o
sweep-folder-holds-one = holds a sweep already; continue it with --resume or give another folder
sweep-folder-holds-another = holds another sweep (other profile, ranges, quantity or version); give another folder, or the options it was begun with
sweep-folder-holds-foreign = holds { $names }, which no sweep of ours wrote or whose beginning and rows are all damaged; give another folder
sweep-lock-is-link = { $name } is a link
sweep-lines-set-aside = damaged lines of the store, by number: { $lines }; set aside in { $file }, their cases were computed again
sweep-disk-full = cannot write ({ $reason }); all rows before are kept: free space and continue with --resume
sweep-cases-kept = { PLAIN($done, digits: 12) } of { PLAIN($count, digits: 12) } cases are on disk in { $folder }
sweep-piece-lost = { PLAIN($done, digits: 12) } of { PLAIN($count, digits: 12) } cases are on disk, piece { PLAIN($piece, digits: 12) } is not
sweep-waits = the cluster has no worker; waiting for one (start it with: dask worker ADDRESS), Ctrl-C ends
sweep-scheduler-gone = { $address } answers no more; { PLAIN($done, digits: 12) } of { PLAIN($count, digits: 12) } cases are on disk
sweep-no-certificate = { $address } needs a certificate, and Dask knows none: state distributed.comm.tls.ca-file and distributed.comm.tls.client.cert and .key in its settings (~/.config/dask), or use tcp://
sweep-no-cluster-extra = needs the cluster extra: pip install "mtcommission[cluster]"
sweep-no-dask = what listens there does not speak as Dask does
sweep-no-scheduler = no scheduler answers at { $address } ({ $why }); start it with: dask scheduler, and give its address as it prints it: tcp:// or tls://
sweep-certificate-refused = with { $address } the certificates among Dask's settings are of no use ({ $why }): check the files distributed.comm.tls.ca-file and distributed.comm.tls.client.cert and .key (~/.config/dask)
sweep-other-scheme = got { $address }, must be an address as dask scheduler prints it, tcp://HOST:PORT or tls://HOST:PORT
