//! A campaign is opened: the lock is taken, and what was left behind, lost or altered since it was last open is seen and
//! made good or refused.

use std::path::{Path, PathBuf};

use super::rebuild::{Rebuild, RebuildSummary, aside};
use super::{agreement, verify};
use crate::domain::Issue;
use crate::domain::words::counted;
use crate::ingest::archive::Archive;
use crate::ingest::{campaign_file, filesystem, profiles};
use crate::pipeline::campaign::context::{keep, now};
use crate::pipeline::campaign::holdings;
use crate::pipeline::{Context, PipelineError, Silent};
use crate::store::journal::Entry;
use crate::store::{self, Found, InstanceLock, Store, StoreError};

impl Context {
    /// Opens a campaign to work on it; takes the lock that keeps a second instance out. A database that an earlier version
    /// made is made anew first.
    ///
    /// # Errors
    /// campaign.toml or a profile is wrong or missing; another instance works; the database cannot be used.
    pub fn open(folder: &Path, allow_network: bool) -> Result<Context, PipelineError> {
        let opened = Context::open_as_made(folder, allow_network);
        let Err(PipelineError::Store(StoreError::Older { found, .. })) = opened else {
            return opened;
        };
        holdings::refuse_loss(folder)?;
        let rebuilt = Rebuild { allow_network }.run(folder, &Silent)?;
        let mut context = Context::open_as_made(folder, allow_network)?;
        context.agreed.push(made_anew(found, &rebuilt));
        Ok(context)
    }

    /// The same, but a database of an earlier version is refused.
    ///
    /// # Errors
    /// As [`Context::open`].
    pub(super) fn open_as_made(folder: &Path, allow_network: bool) -> Result<Context, PipelineError> {
        let loaded = campaign_file::read(folder)?;
        refuse_network(folder, allow_network)?;
        let mut lock = InstanceLock::take(folder)?;
        // Whoever was killed while it archived left these; with the lock held nobody writes them now.
        Archive::new(folder).remove_partial()?;
        holdings::refuse_lost_database(folder)?;
        let store = open_locked(folder, &lock)?;
        holdings::check_and_mark(folder, &store)?;
        keep(folder, &loaded)?;
        aside::clear(folder);
        let ended_in_order = lock.last_ended_in_order();
        let mut context = Context::with(folder, loaded, store, None);
        context.agreed = agreement::agree(&mut context, !ended_in_order)?;
        lock.found_sound();
        context.lock = Some(lock);
        if let Some(lost) = verify::cut(&context)? {
            context.store.say(&now(), vec![(now(), Entry::Missed { lost })])?;
        }
        context.agreed.extend(verify::missed(&context)?);
        if !ended_in_order {
            context.damage = verify::of_archive(&context)?;
        }
        Ok(context)
    }

    /// The same with a new database; what lies in its place is moved aside, and its new name given.
    ///
    /// # Errors
    /// As [`Context::open`].
    pub fn open_with_new_database(
        folder: &Path,
        allow_network: bool,
    ) -> Result<(Context, Option<PathBuf>), PipelineError> {
        let loaded = campaign_file::read(folder)?;
        refuse_network(folder, allow_network)?;
        let mut lock = InstanceLock::take(folder)?;
        let archive = Archive::new(folder);
        archive.remove_partial()?;
        // Nobody says a word between the two.
        let _held = store::journal::hold(folder)?;
        let mark = store::free_mark(folder, &now())?;
        let aside = store::set_aside(folder, &mark)?;
        store::journal::set_aside(folder, &mark)?;
        let store = Store::open(folder)?;
        archive.set_owner(&store.identity()?)?;
        lock.found_sound();
        keep(folder, &loaded)?;
        Ok((Context::with(folder, loaded, store, Some(lock)), aside))
    }

    /// The same with a new archive, or what is left of the old one; every file is read again, so that its bytes are
    /// archived.
    ///
    /// # Errors
    /// As [`Context::open`].
    pub fn open_with_new_archive(folder: &Path, allow_network: bool) -> Result<Context, PipelineError> {
        let loaded = campaign_file::read(folder)?;
        refuse_network(folder, allow_network)?;
        let mut lock = InstanceLock::take(folder)?;
        holdings::refuse_lost_database(folder)?;
        let mut store = open_locked(folder, &lock)?;
        store.read_again(&now())?;
        Archive::new(folder).set_owner(&store.identity()?)?;
        keep(folder, &loaded)?;
        let mut context = Context::with(folder, loaded, store, None);
        context.agreed = agreement::agree(&mut context, !lock.last_ended_in_order())?;
        lock.found_sound();
        context.lock = Some(lock);
        Ok(context)
    }

    /// Begins a new database of a campaign beside the one that it has, in a folder of its own; nothing that is done with it
    /// goes to the journal. Whatever lies in the place of the old one is not looked at.
    ///
    /// # Errors
    /// As [`Context::open`]; the folder cannot be made, or holds what the program did not write.
    pub fn open_aside(folder: &Path, allow_network: bool) -> Result<Context, PipelineError> {
        let loaded = campaign_file::read(folder)?;
        // What waits for a profile would not come back.
        profiles::load(folder).strict()?;
        refuse_network(folder, allow_network)?;
        let lock = InstanceLock::take(folder)?;
        Archive::new(folder).remove_partial()?;
        let aside = aside::emptied(folder)?;
        let mut store = Store::open(aside.path())?;
        store.keep_journal_heard();
        let context = Context::with(folder, loaded, store, Some(lock));
        Ok(Context {
            aside: Some(aside),
            ..context
        })
    }

    /// Puts the database that was begun so in the place of the old one, which is moved aside; gives its new name.
    ///
    /// # Errors
    /// The new database does not read back from its file as it was made, or a file cannot be renamed; the new database then
    /// is removed, or stays where it was made where the old one has been moved.
    pub fn put_in_place(self) -> Result<Option<PathBuf>, PipelineError> {
        let Context {
            folder,
            store,
            mut lock,
            aside,
            ..
        } = self;
        // From here on it may be the only database that there is.
        drop(aside);
        let put = store.close_whole().and_then(|()| {
            let mark = store::free_mark(&folder, &now())?;
            store::put_in_place(&aside::path_in(&folder), &folder, &mark)
        });
        let old = put.inspect_err(|_| aside::clear(&folder))?;
        aside::remove(&folder)?;
        if let Some(lock) = lock.as_mut() {
            lock.found_sound();
        }
        Ok(old)
    }

    /// Removes the database that was begun so.
    pub fn leave_aside(self) {
        let Context {
            folder,
            store,
            lock: _lock,
            ..
        } = self;
        drop(store);
        aside::clear(&folder);
    }

    /// The same campaign with another database.
    pub(crate) fn with_store(&self, store: Store) -> Result<Context, PipelineError> {
        let loaded = campaign_file::or_kept(&self.folder);
        Ok(Context::with(&self.folder, loaded, store, None))
    }

    /// Opens a campaign beside a working instance, for changes that do not read files or fit.
    ///
    /// # Errors
    /// As [`Context::open`]; the lock is needed only where the database is to be brought up to date, or it and the journal do
    /// not say the same.
    pub fn open_beside(folder: &Path, allow_network: bool) -> Result<Context, PipelineError> {
        let loaded = campaign_file::read(folder)?;
        refuse_network(folder, allow_network)?;
        holdings::refuse_lost_database(folder)?;
        let is_ready = match Store::open_read_only(folder) {
            Ok(Some(store)) => store.is_agreed(folder)?,
            Ok(None) => true,
            Err(StoreError::Older { .. }) => false,
            Err(error) => return Err(error.into()),
        };
        let agreed = if is_ready {
            Vec::new()
        } else {
            Context::open(folder, allow_network)?.agreed
        };
        let store = Store::open(folder)?;
        holdings::check(folder, &store)?;
        let context = Context::with(folder, loaded, store, None);
        Ok(Context { agreed, ..context })
    }

    /// Opens a campaign to read from it, without a lock and without a change. Where there is no database yet an empty one in
    /// memory stands in. Settings that cannot be read are told ([`Context::warnings`]), and so is what the database and the
    /// journal lack of each other: whoever works on the campaign next makes that good.
    ///
    /// # Errors
    /// There is no campaign; the database is gone or cannot be read, or it and the journal are of two courses.
    pub fn open_read_only(folder: &Path) -> Result<Context, PipelineError> {
        let mut context = Context::open_as_it_is(folder)?;
        context.agreed = verify::behind(&context)?;
        Ok(context)
    }

    /// The same, but the journal is not looked at.
    ///
    /// # Errors
    /// There is no campaign; the database is gone or cannot be read.
    pub fn open_as_it_is(folder: &Path) -> Result<Context, PipelineError> {
        // Without a database there is nothing to show, and whoever begins a campaign is told what is wrong.
        let has_database = store::found(folder) == Found::Something;
        let loaded = if has_database {
            campaign_file::or_kept(folder)
        } else {
            campaign_file::read(folder)?
        };
        holdings::refuse_lost_database(folder)?;
        let store = match Store::open_read_only(folder)? {
            Some(store) => store,
            None => Store::in_memory()?,
        };
        Ok(Context::with(folder, loaded, store, None))
    }
}

/// What is said where the database of an earlier version was made anew.
fn made_anew(schema: i64, rebuilt: &RebuildSummary) -> Issue {
    let aside = rebuilt.set_aside.as_deref().and_then(Path::file_name);
    let message = format!(
        "an earlier version of the program made the database (schema {schema}): it was made anew from archive, journal and folder \
         ({} with their tags, {}); fits and findings are made again, and the old one lies beside it as {}",
        counted(rebuilt.runs, "run"),
        counted(rebuilt.words, "word"),
        aside.map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
    );
    Issue::note("database-made-anew", message)
}

/// Opens the database for whoever holds the lock; after a disorderly end its structure is looked at first.
fn open_locked(folder: &Path, lock: &InstanceLock) -> Result<Store, StoreError> {
    let store = Store::open(folder)?;
    if !lock.last_ended_in_order() {
        store.check_structure()?;
    }
    Ok(store)
}

/// SQLite's write-ahead log needs shared memory, which network file systems do not give.
fn refuse_network(folder: &Path, allow_network: bool) -> Result<(), PipelineError> {
    // Where the system cannot tell, the file system is taken as local.
    match filesystem::network_kind(folder).ok().flatten() {
        Some(kind) if !allow_network => {
            let path = folder.join(crate::store::FILE_NAME);
            Err(StoreError::NetworkShare {
                path,
                kind: kind.to_owned(),
            }
            .into())
        }
        _ => Ok(()),
    }
}
